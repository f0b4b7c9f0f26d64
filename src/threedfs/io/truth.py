"""Depth images of an RGB-D camera as ground truth."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import cv2
import numpy as np

from threedfs.errors import UserError
from threedfs.geometry.registration import register_depth
from threedfs.types import Camera

_MISSING_DEPTHS = (0, 65535)


def read_depth_image(path: Path, scale: float) -> np.ndarray:
    """Read a depth image, uint16 along the camera's z axis; return (H, W) float64, NaN = missing (0 or 65535).

    Parameters
    ----------
    path : Path
    scale : float
        Depth units per unit of the true cameras: 1000 for millimetres beside cameras in metres.

    Raises
    ------
    UserError
        If the file is missing, cannot be decoded, or is not of one 16-bit channel.
    """
    image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED) if Path(path).is_file() else None
    if image is None:
        raise UserError(f"{path}: expected a depth image, found none that can be decoded; check the file.")
    if image.dtype != np.uint16 or image.ndim != 2:
        raise UserError(f"{path}: expected one channel of 16-bit depths, got {image.dtype} of shape {image.shape}.")
    return np.where(np.isin(image, _MISSING_DEPTHS), np.nan, image / scale)


def read_true_depth(
    path: Path,
    scale: float,
    shape: tuple[int, int],
    depth_camera: Mapping[str, Sequence[float]] | None = None,
    colour: Camera | None = None,
) -> np.ndarray:
    """Read a depth image in the geometry of the source frames; return (H, W) float64, NaN = missing.

    Parameters
    ----------
    path, scale
        As for `read_depth_image`.
    shape : (2,) int
        Rows and columns of the source frames.
    depth_camera : mapping, optional
        `intrinsics` and `offset` of the camera that measured it, as `register_depth` takes them, if that was not the
        colour camera.
    colour : Camera, optional
        The true camera of the frame, at the size of the source; without it depth stays as it was measured.

    Raises
    ------
    UserError
        As `read_depth_image`, or if the image is not of the size of the source frames.
    """
    image = read_depth_image(path, scale)
    if depth_camera is not None and colour is not None:
        image = register_depth(image, **depth_camera, colour=colour)
    if image.shape != tuple(shape):
        raise UserError(
            f"{path}: expected a depth image of {shape[1]} x {shape[0]} pixels (width x height) like the source "
            f"frames, got {image.shape[1]} x {image.shape[0]}; save it at their resolution and orientation."
        )
    return image
