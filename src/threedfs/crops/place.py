"""Where in the frames the object's box lies: a crop for each, a view like any other with its own camera."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from threedfs.frames.scale import scale_camera, working_shape
from threedfs.geometry.projection import project
from threedfs.types import Camera, View

_LEAST_SIDE = 32
"""Source pixels below which a crop shows nothing of the object: the frame is taken whole."""
_HALVINGS = 60


@dataclass(frozen=True)
class Window:
    """A rectangle of an undistorted source frame, and how it is resampled.

    Attributes
    ----------
    left, top, right, bottom : int
        Edges in source pixels: the window holds the pixels left <= u < right, top <= v < bottom.
    pixel_size : float
        World length of a source pixel at the middle of the box, scene units.
    """

    left: int
    top: int
    right: int
    bottom: int
    pixel_size: float

    def area(self, pixel_size: float) -> float:
        """Return the crop's pixels where one is to cover `pixel_size`, scene units; source pixels are not divided."""
        scale = min(1.0, self.pixel_size / pixel_size)
        return (self.right - self.left) * (self.bottom - self.top) * scale**2


def place_crops(views: Sequence[View], corners: np.ndarray, margin: float, pixels: int) -> list[View]:
    """Return a view of the box for every view of a whole source frame.

    All crops have pixels of one size at the object, so that what is counted in pixels means the same in each: as fine
    as the mean of their areas allows, but never finer than the source. A frame that shows nothing of the box, or has
    it partly behind its camera, is taken whole, with an area of `pixels` at most.

    Parameters
    ----------
    views : sequence of View
        Of the undistorted frames, at the resolution of the source.
    corners : (8, 3) float64
        Of the box, world, scene units.
    margin : float
        What the window exceeds the box by on each side, as a share of the window's longer side.
    pixels : int
        Mean area of the crops.
    """
    windows = [find_window(view, corners, margin) for view in views]
    shown = [window for window in windows if window]
    size = choose_pixel_size(shown, pixels) if shown else 0.0
    return [
        cut_view(view, window, min(1.0, window.pixel_size / size)) if window else take_whole(view, pixels)
        for view, window in zip(views, windows, strict=True)
    ]


def find_window(view: View, corners: np.ndarray, margin: float) -> Window | None:
    """Return the part of a source frame around a box (8, 3); none where it is not in view, or partly behind."""
    camera = view.camera
    places, depth = project(view, corners)
    distance = float(view.cam_from_world[2] @ np.append(corners.mean(axis=0), 1))
    if depth.min() > 0:
        low, high = places.min(axis=0), places.max(axis=0)
        last = np.array([camera.width, camera.height]) - 0.5
        if (np.minimum(high, last) - np.maximum(low, -0.5)).min() < _LEAST_SIDE:
            return None
        reach = margin * (high - low).max()
        left, top = np.floor(np.maximum(low - reach, -0.5) + 0.5).astype(int)
        right, bottom = np.ceil(np.minimum(high + reach, last) + 0.5).astype(int)
        return Window(int(left), int(top), int(right), int(bottom), distance / camera.fx)
    return None


def take_whole(view: View, pixels: int) -> View:
    """Return the view of the whole frame with an area of `pixels` at most."""
    camera = view.camera
    scale = min(1.0, (pixels / (camera.width * camera.height)) ** 0.5)
    return cut_view(view, Window(0, 0, camera.width, camera.height, 0.0), scale)


def choose_pixel_size(windows: Sequence[Window], pixels: int) -> float:
    """Return the world length of a crop's pixel at which the mean area of the crops is at most `pixels`."""
    fine = min(window.pixel_size for window in windows)
    coarse = max(window.pixel_size for window in windows)
    while np.mean([window.area(coarse) for window in windows]) > pixels:
        coarse *= 2
    for _ in range(_HALVINGS):
        middle = (fine + coarse) / 2
        if np.mean([window.area(middle) for window in windows]) > pixels:
            fine = middle
        else:
            coarse = middle
    return coarse


def cut_view(view: View, window: Window, scale: float) -> View:
    """Return the view of a window at `scale` crop pixels for each source pixel."""
    camera = view.camera
    cut = Camera(
        width=int(np.ceil((window.right - window.left) * scale)),
        height=int(np.ceil((window.bottom - window.top) * scale)),
        fx=camera.fx * scale,
        fy=camera.fy * scale,
        cx=(camera.cx + 0.5 - window.left) * scale - 0.5,
        cy=(camera.cy + 0.5 - window.top) * scale - 0.5,
    )
    return replace(view, camera=cut)


def measure_object(views: Sequence[View], corners: np.ndarray) -> float | None:
    """Return how long the longest side of a box (8, 3) is in views that it is in front of, pixels, in the median."""
    middle = np.append(corners.mean(axis=0), 1)
    longest = max(float(np.linalg.norm(corner - corners[0])) for corner in corners[[1, 2, 4]])
    depths = [float(view.cam_from_world[2] @ middle) for view in views]
    lengths = [view.camera.fx * longest / depth for view, depth in zip(views, depths, strict=True) if depth > 0]
    return float(np.median(lengths)) if lengths else None


def shrink_view(view: View, longest_side: int) -> View:
    """Return the view of the whole frame, its longer side at most `longest_side` pixels."""
    shape = working_shape(view.camera.shape, longest_side)
    return replace(view, camera=scale_camera(view.camera, shape, f"frame {view.name}"))
