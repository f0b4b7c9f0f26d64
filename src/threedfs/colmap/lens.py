"""Cameras at COLMAP's border.

COLMAP puts the centre of the first pixel at (0.5, 0.5); everywhere else here it is (0, 0). The conversion
happens in this module and nowhere else.
"""

from __future__ import annotations

import numpy as np
import pycolmap

from threedfs.geometry.lens import Lens
from threedfs.types import Camera

HALF_PIXEL = 0.5


def colmap_from_px(pixels: np.ndarray) -> np.ndarray:
    """Convert pixels (..., 2) with integer centres to COLMAP's, whose first pixel has its centre at (0.5, 0.5)."""
    return pixels + HALF_PIXEL


def px_from_colmap(pixels: np.ndarray) -> np.ndarray:
    """Convert COLMAP's pixels (..., 2) to integer centres."""
    return pixels - HALF_PIXEL


def make_colmap_camera(lens: Lens, camera_id: int) -> pycolmap.Camera:
    """Return a COLMAP camera of known intrinsics (model OPENCV without tangential terms)."""
    camera = lens.camera
    return pycolmap.Camera(
        camera_id=camera_id,
        model=pycolmap.CameraModelId.OPENCV,
        width=camera.width,
        height=camera.height,
        params=[camera.fx, camera.fy, *colmap_from_px(np.array([camera.cx, camera.cy])), lens.k1, lens.k2, 0.0, 0.0],
        has_prior_focal_length=True,
    )


def make_simple_camera(lens: Lens, camera_id: int) -> pycolmap.Camera:
    """Return a COLMAP camera to be refined: one focal length, that across, and k1 (model SIMPLE_RADIAL)."""
    camera = lens.camera
    return pycolmap.Camera(
        camera_id=camera_id,
        model=pycolmap.CameraModelId.SIMPLE_RADIAL,
        width=camera.width,
        height=camera.height,
        params=[camera.fx, *colmap_from_px(np.array([camera.cx, camera.cy])), lens.k1],
    )


def guess_colmap_camera(width: int, height: int, focal_factor: float, camera_id: int) -> pycolmap.Camera:
    """Return a COLMAP camera to be self-calibrated: one focal length and k1, its centre in the image's middle."""
    return pycolmap.Camera.create_from_model_id(
        camera_id, pycolmap.CameraModelId.SIMPLE_RADIAL, focal_factor * max(width, height), width, height
    )


def read_colmap_camera(camera: pycolmap.Camera) -> Lens:
    """Return the lens of a COLMAP camera.

    Raises
    ------
    ValueError
        If its model has terms other than radial ones of second and fourth order.
    """
    parameters = [float(value) for value in camera.params]
    kind = camera.model.name
    if kind == "SIMPLE_PINHOLE":
        focal, radial = parameters[:1] * 2, (0.0, 0.0)
    elif kind == "PINHOLE":
        focal, radial = parameters[:2], (0.0, 0.0)
    elif kind == "SIMPLE_RADIAL":
        focal, radial = parameters[:1] * 2, (parameters[3], 0.0)
    elif kind == "RADIAL":
        focal, radial = parameters[:1] * 2, (parameters[3], parameters[4])
    elif kind == "OPENCV" and not any(parameters[6:]):
        focal, radial = parameters[:2], (parameters[4], parameters[5])
    else:
        raise ValueError(f"camera model {kind} with parameters {parameters}")
    cx, cy = px_from_colmap(np.array([camera.principal_point_x, camera.principal_point_y]))
    return Lens(Camera(camera.width, camera.height, focal[0], focal[1], float(cx), float(cy)), *radial)
