"""Depth images of an RGB-D camera as ground truth."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from threedfs.errors import UserError

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
