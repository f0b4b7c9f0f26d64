"""Filming a scene: every frame of a video with its exact camera, mask and depth."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from threedfs.synthetic.blur import image_motion, smear
from threedfs.synthetic.path import HandheldPath
from threedfs.synthetic.render import Renderer
from threedfs.synthetic.scene import Scene
from threedfs.synthetic.sensor import Sensor
from threedfs.types import Camera, View


@dataclass(frozen=True)
class Film:
    """What is filmed and how.

    Attributes
    ----------
    scene : Scene
    camera : Camera
    path : HandheldPath
    sensor : Sensor
    frames : int
        Number of frames.
    rate : int or Fraction
        Frames per second.
    shutter : float
        Exposure of a frame, seconds.
    samples : int
        Images averaged per frame for anti-aliasing and motion blur.
    smooth : bool
        Whether each of them is blurred over its part of the exposure, or sharp: few samples then do for long exposures.
    """

    scene: Scene
    camera: Camera
    path: HandheldPath
    sensor: Sensor
    frames: int
    rate: int | Fraction
    shutter: float
    samples: int = 4
    smooth: bool = False

    def time(self, frame: int) -> float:
        """Return the middle of a frame's exposure, seconds."""
        return float(frame / self.rate)

    def view(self, frame: int) -> View:
        """Return the view of a frame at the middle of its exposure."""
        return View(f"{frame:06d}", self.camera, self.path.cam_from_world(self.time(frame)))

    def shoot(self, renderer: Renderer, frame: int) -> np.ndarray:
        """Return frame number `frame` as the sensor records it, (H, W, 3) uint8."""
        time = self.time(frame)
        light = expose(renderer, self.camera, self.path.cam_from_world, time, self.shutter, self.samples, self.smooth)
        return self.sensor.record(light, frame, time)


def expose(
    renderer: Renderer,
    camera: Camera,
    cam_from_world: Callable[[float], np.ndarray],
    time: float,
    shutter: float,
    samples: int,
    smooth: bool = False,
) -> np.ndarray:
    """Return the mean radiance (H, W, 3) while the shutter is open, anti-aliased.

    Parameters
    ----------
    renderer : Renderer
    camera : Camera
    cam_from_world : callable
        Pose at a time in seconds.
    time : float
        Middle of the exposure, seconds.
    shutter : float
        Its length, seconds.
    samples : int
        Images averaged; each has its own moment and its own place in the pixel.
    smooth : bool
        Whether each is blurred over its part of the exposure.
    """
    index = np.arange(samples)
    shifts = np.column_stack([(0.5 + index * 0.7548776662) % 1, (0.5 + index * 0.5698402910) % 1])
    shifts -= shifts.mean(axis=0)  # on average the pixel's centre, so that images agree with the poses
    total = np.zeros((*camera.shape, 3))
    for k in range(samples):
        start, moment, end = (time + shutter * ((k + part) / samples - 0.5) for part in (0.0, 0.5, 1.0))
        middle = cam_from_world(moment)
        image, depth = renderer.look(View("", camera, middle), tuple(shifts[k]))
        if smooth:
            image = smear(image, depth, image_motion(camera, depth, cam_from_world(start), cam_from_world(end), middle))
        total += image
    return total / samples


def shoot_all(
    film: Film, renderer: Renderer, processes: int, frames: Sequence[int] | None = None
) -> Iterator[np.ndarray]:
    """Yield the frames in order, rendered on several processes; the images do not depend on how many."""
    yield from map_forked(
        lambda frame: film.shoot(renderer, frame), range(film.frames) if frames is None else frames, processes
    )


def map_forked(work: Callable[[Any], Any], items: Sequence[Any], processes: int) -> Iterator[Any]:
    """Yield `work(item)` in the order of the items, done on several processes.

    They are forked and so share what `work` refers to, which holds functions that cannot be sent.
    """
    if processes <= 1:
        yield from map(work, items)
        return
    global _shared
    _shared = work
    with multiprocessing.get_context("fork").Pool(processes) as pool:
        yield from pool.imap(_do_shared, items)


_shared: Callable[[Any], Any] | None = None


def _do_shared(item: Any) -> Any:
    return _shared(item)
