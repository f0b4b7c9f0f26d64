"""The way a hand carries a camera around an object."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from threedfs.geometry.rigid import look_at, make_transform


@dataclass(frozen=True)
class HandheldPath:
    """An orbit with changing height and distance, uneven pace, and shake.

    Attributes
    ----------
    duration : float
        Seconds.
    turns : float
        Part of a circle, 1 for a full one; negative goes clockwise seen from above.
    start : float
        Azimuth at the start, degrees; 0 is on +x, 90 on +y.
    distance : (2,) float
        Least and largest distance from the target, scene units.
    elevation : (2,) float
        Least and largest elevation above the horizontal, degrees.
    target : (3,) float
        What the camera looks at, world.
    waves : float
        How many times height goes up and down on the way.
    unevenness : float
        Relative variation of the pace, 0 to below 1.
    shake_position, shake_rotation : float
        Root mean square of the hand's tremor, in scene units and degrees.
    wander : float
        Root mean square of the slow drift of the aim, degrees.
    jolts : int
        How many times the hand starts: the aim jumps and comes back within a fifth of a second.
    seed : int
        Another seed, another hand.
    """

    duration: float
    turns: float = 1.0
    start: float = 0.0
    distance: tuple[float, float] = (0.6, 0.75)
    elevation: tuple[float, float] = (20.0, 50.0)
    target: tuple[float, float, float] = (0.0, 0.0, 0.1)
    waves: float = 1.5
    unevenness: float = 0.3
    shake_position: float = 0.002
    shake_rotation: float = 0.15
    wander: float = 1.2
    jolts: int = 0
    seed: int = 0

    def cam_from_world(self, time: float) -> np.ndarray:
        """Return the (4, 4) pose at a time in seconds; smooth in time and defined a little beyond both ends."""
        rng = np.random.default_rng(self.seed)
        phase = rng.uniform(0, 2 * np.pi, 4)
        share = time / self.duration
        # Pace and height follow slow sines; integer-free frequencies keep them from repeating.
        advance = share + self.unevenness / (2 * np.pi * 1.7) * (
            np.sin(2 * np.pi * 1.7 * share + phase[0]) - np.sin(phase[0])
        )
        azimuth = np.radians(self.start) + 2 * np.pi * self.turns * advance
        rise = 0.5 + 0.5 * np.sin(2 * np.pi * self.waves * share + phase[1])
        elevation = np.radians(self.elevation[0] + (self.elevation[1] - self.elevation[0]) * rise)
        reach = 0.5 + 0.5 * np.sin(2 * np.pi * 1.3 * share + phase[2])
        distance = self.distance[0] + (self.distance[1] - self.distance[0]) * reach
        outward = np.array(
            [np.cos(azimuth) * np.cos(elevation), np.sin(azimuth) * np.cos(elevation), np.sin(elevation)]
        )
        centre = np.asarray(self.target) + distance * outward
        centre = centre + self.shake_position * _tremor(rng, time, 3, 0.8, 6.0)
        aimed = look_at(centre, np.asarray(self.target), np.array([0.0, 0.0, 1.0]))
        slow = self.wander * _tremor(rng, time, 3, 0.12, 0.6)
        fast = self.shake_rotation * _tremor(rng, time, 3, 1.0, 9.0)
        sudden = _starts(rng, time, self.duration, self.jolts)
        return make_transform(_small_rotation(np.radians(slow + fast + sudden)), np.zeros(3)) @ aimed


def _tremor(rng: np.random.Generator, time: float, size: int, low: float, high: float) -> np.ndarray:
    """Band-limited noise (size,) of unit variance between two frequencies in hertz, slower parts stronger."""
    frequency = np.geomspace(low, high, 8) * rng.uniform(0.9, 1.1, (size, 8))
    amplitude = 1 / np.sqrt(frequency)
    amplitude /= np.sqrt((amplitude**2).sum(-1, keepdims=True) / 2)
    return (amplitude * np.sin(2 * np.pi * frequency * time + rng.uniform(0, 2 * np.pi, (size, 8)))).sum(-1)


def _starts(rng: np.random.Generator, time: float, duration: float, count: int) -> np.ndarray:
    """Rotation (3,), degrees, of a hand that starts `count` times, about 2 degrees each, evenly spread with chance."""
    moments = (np.arange(count) + rng.uniform(0.2, 0.8, count)) / max(count, 1) * duration
    axes = rng.normal(0.0, (1.4, 1.4, 0.6), (count, 3))
    return np.exp(-(((time - moments) / 0.07) ** 2)) @ axes


def _small_rotation(vector: np.ndarray) -> np.ndarray:
    """Rotation (3, 3) about `vector` by its length in radians (Rodrigues)."""
    angle = np.linalg.norm(vector)
    if angle == 0:
        return np.eye(3)
    x, y, z = vector / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
