"""Tabletop-12: what makes a take of an object on its support, filmed by a casual hand."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from threedfs.geometry.rigid import look_at
from threedfs.synthetic.film import Film
from threedfs.synthetic.path import HandheldPath
from threedfs.synthetic.scene import Scene
from threedfs.synthetic.sensor import Sensor
from threedfs.synthetic.solid import Solid
from threedfs.types import Camera, View

SECONDS = 8.0
# Focal length of the phone, all takes have the same, in widths of the image.
_FOCAL = 525 / 640


@dataclass(frozen=True)
class Take:
    """A take: what is there and how it is filmed.

    Attributes
    ----------
    scene : Scene
    path : HandheldPath
    sensor : Sensor
    shutter : float
        Exposure of a frame, seconds.
    """

    scene: Scene
    path: HandheldPath
    sensor: Sensor
    shutter: float

    def film(self, frames: int, width: int, samples: int) -> Film:
        """Return the film of `SECONDS` with so many frames, 4:3, `width` pixels wide."""
        return Film(
            scene=self.scene,
            camera=phone(width),
            path=self.path,
            sensor=self.sensor,
            frames=frames,
            rate=Fraction(frames) / Fraction(SECONDS),
            shutter=self.shutter,
            samples=samples,
            smooth=True,
        )

    def unseen(self, width: int, count: int) -> tuple[View, ...]:
        """Return views `unseen_00`, ... from all sides, nearer or farther than the path ever is."""
        rng = np.random.default_rng([self.path.seed, 24])
        near, far = self.path.distance
        target = np.asarray(self.path.target)
        views = []
        for index in range(count):
            azimuth = 2 * np.pi * (index + rng.uniform(0.1, 0.9)) / count
            # Nearer and farther in turn, at heights that do not follow the order of the azimuths.
            distance = rng.uniform(0.80, 0.92) * near if index % 2 else rng.uniform(1.08, 1.25) * far
            elevation = np.radians(12 + 58 * ((index * 0.6180339887 + rng.uniform(0, 0.1)) % 1))
            outward = np.array(
                [np.cos(azimuth) * np.cos(elevation), np.sin(azimuth) * np.cos(elevation), np.sin(elevation)]
            )
            aim = target + 0.03 * distance * rng.standard_normal(3)
            tilt = np.array([0.06, 0.06, 0.0]) * rng.standard_normal(3)
            pose = look_at(target + distance * outward, aim, np.array([0.0, 0.0, 1.0]) + tilt)
            views.append(View(f"unseen_{index:02d}", phone(width), pose))
        return tuple(views)


def phone(width: int) -> Camera:
    """Return the camera that films all takes: 4:3, without distortion."""
    height = width * 3 // 4
    return Camera(width, height, _FOCAL * width, _FOCAL * width, (width - 1) / 2, (height - 1) / 2)


def walk(
    solid: Solid,
    *,
    seed: int,
    start: float,
    turns: float,
    elevation: tuple[float, float] = (22.0, 52.0),
    share: tuple[float, float] = (0.24, 0.34),
    waves: float = 1.5,
    jolts: int = 3,
) -> HandheldPath:
    """Make a casual walk around an object, from so far that it fills a given share of the image's width.

    Parameters
    ----------
    solid : Solid
    seed : int
        Another seed, another hand.
    start, turns, elevation, waves, jolts
        As in `HandheldPath`.
    share : (2,) float
        Least and largest share of the width, in the mean over all sides; tall objects count by their height.
    """
    corners = solid.mesh.vertices
    low, high = corners.min(axis=0), corners.max(axis=0)
    angles = np.radians(np.arange(0, 180, 5))
    widths = [np.ptp(corners[:, 0] * np.cos(a) + corners[:, 1] * np.sin(a)) for a in angles]
    size = max(float(np.mean(widths)), 0.75 * float(high[2] - low[2]))
    distance = (_FOCAL * size / share[1], _FOCAL * size / share[0])
    return HandheldPath(
        duration=SECONDS,
        turns=turns,
        start=start,
        distance=distance,
        elevation=elevation,
        target=(float(low[0] + high[0]) / 2, float(low[1] + high[1]) / 2, 0.45 * float(high[2])),
        waves=waves,
        unevenness=0.4,
        shake_position=0.007 * sum(distance) / 2,
        shake_rotation=0.35,
        wander=1.6,
        jolts=jolts,
        seed=seed,
    )
