"""A camera with radial distortion."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from threedfs.types import Camera


@dataclass(frozen=True)
class Lens:
    """A camera with radial distortion.

    Attributes
    ----------
    camera : Camera
        The pinhole camera of the undistorted image, integer pixel centres.
    k1, k2 : float
        A point at normalised (x, y) is seen at (x, y) (1 + k1 r^2 + k2 r^4).
    """

    camera: Camera
    k1: float = 0.0
    k2: float = 0.0

    def resize(self, width: int, height: int) -> Lens:
        """Return the lens for the same image scaled to width x height pixels: u' + 0.5 = (u + 0.5) width' / width."""
        camera = self.camera
        across, down = width / camera.width, height / camera.height
        resized = Camera(
            width,
            height,
            camera.fx * across,
            camera.fy * down,
            (camera.cx + 0.5) * across - 0.5,
            (camera.cy + 0.5) * down - 0.5,
        )
        return replace(self, camera=resized)

    def normalise(self, pixels: np.ndarray) -> np.ndarray:
        """Return the undistorted normalised coordinates (N, 2) of raw pixels (N, 2), by fixed-point iteration."""
        camera = self.camera
        seen = (pixels - (camera.cx, camera.cy)) / (camera.fx, camera.fy)
        ideal = seen.copy()
        for _ in range(30):  # each step contracts by about 3 |k1| r^2: float64 precision for any usable lens
            radius2 = (ideal**2).sum(-1, keepdims=True)
            ideal = seen / (1 + self.k1 * radius2 + self.k2 * radius2**2)
        return ideal

    def denormalise(self, ideal: np.ndarray) -> np.ndarray:
        """Return the raw pixels (N, 2) at which undistorted normalised coordinates (N, 2) are seen."""
        radius2 = (ideal**2).sum(-1, keepdims=True)
        seen = ideal * (1 + self.k1 * radius2 + self.k2 * radius2**2)
        return seen * (self.camera.fx, self.camera.fy) + (self.camera.cx, self.camera.cy)
