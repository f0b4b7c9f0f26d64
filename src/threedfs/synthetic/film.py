"""Filming a scene: every frame of a video with its exact camera, mask and depth."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

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
    rate : int
        Frames per second.
    shutter : float
        Exposure of a frame, seconds.
    samples : int
        Images averaged per frame for anti-aliasing and motion blur.
    """

    scene: Scene
    camera: Camera
    path: HandheldPath
    sensor: Sensor
    frames: int
    rate: int
    shutter: float
    samples: int = 4

    def view(self, frame: int) -> View:
        """Return the view of a frame at the middle of its exposure."""
        return View(f"{frame:06d}", self.camera, self.path.cam_from_world(frame / self.rate))

    def shoot(self, renderer: Renderer, frame: int) -> np.ndarray:
        """Return frame number `frame` as the sensor records it, (H, W, 3) uint8."""
        time = frame / self.rate
        light = expose(renderer, self.camera, self.path.cam_from_world, time, self.shutter, self.samples)
        return self.sensor.record(light, frame, time)


def expose(
    renderer: Renderer,
    camera: Camera,
    cam_from_world: Callable[[float], np.ndarray],
    time: float,
    shutter: float,
    samples: int,
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
    """
    index = np.arange(samples)
    shifts = np.column_stack([(0.5 + index * 0.7548776662) % 1, (0.5 + index * 0.5698402910) % 1])
    shifts -= shifts.mean(axis=0)  # on average the pixel's centre, so that images agree with the poses
    total = np.zeros((*camera.shape, 3))
    for k in range(samples):
        moment = time + shutter * ((k + 0.5) / samples - 0.5)
        total += renderer.radiance(View("", camera, cam_from_world(moment)), tuple(shifts[k]))
    return total / samples


def shoot_all(
    film: Film, renderer: Renderer, processes: int, frames: Sequence[int] | None = None
) -> Iterator[np.ndarray]:
    """Yield the frames in order, rendered on several processes; the images do not depend on how many."""
    wanted = range(film.frames) if frames is None else frames
    if processes <= 1:
        for frame in wanted:
            yield film.shoot(renderer, frame)
        return
    # Forked workers share the scene, which holds functions that cannot be sent.
    global _shared
    _shared = (film, renderer)
    with multiprocessing.get_context("fork").Pool(processes) as pool:
        yield from pool.imap(_shoot_shared, wanted)


_shared: tuple[Film, Renderer] | None = None


def _shoot_shared(frame: int) -> np.ndarray:
    film, renderer = _shared
    return film.shoot(renderer, frame)
