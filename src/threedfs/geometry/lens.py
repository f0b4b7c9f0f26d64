"""A camera with radial distortion."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from threedfs.geometry.distortion import distort, undistort
from threedfs.types import Camera


@dataclass(frozen=True)
class Lens:
    """A camera with radial distortion.

    Attributes
    ----------
    camera : Camera
        The pinhole camera of the undistorted image, integer pixel centres.
    k1, k2 : float
        Radial distortion, see `threedfs.geometry.distortion`.
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
        """Return the undistorted normalised coordinates (..., 2) of raw pixels (..., 2); NaN where there are none."""
        camera = self.camera
        return undistort((pixels - (camera.cx, camera.cy)) / (camera.fx, camera.fy), (self.k1, self.k2))

    def denormalise(self, ideal: np.ndarray) -> np.ndarray:
        """Return the raw pixels (..., 2) at which undistorted normalised coordinates (..., 2) are seen.

        NaN where the lens does not show them.
        """
        camera = self.camera
        return distort(ideal, (self.k1, self.k2)) * (camera.fx, camera.fy) + (camera.cx, camera.cy)
