"""Depth images of an RGB-D camera as ground truth."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import cv2
import numpy as np

from threedfs.errors import UserError

_DEPTH_SUFFIX = ".depth.png"
_MISSING_DEPTHS = (0, 65535)


def find_depth_images(folder: Path, names: Iterable[str]) -> dict[str, Path]:
    """Find the depth image of every frame that has one: NAME.depth.png, for a photo NAME.color.jpg too.

    Raises
    ------
    UserError
        If no depth image in the folder belongs to a frame.
    """
    files = {path.name.removesuffix(_DEPTH_SUFFIX): path for path in sorted(Path(folder).glob(f"*{_DEPTH_SUFFIX}"))}
    found = {name: files[stem] for name in names if (stem := name.removesuffix(".color")) in files}
    if not found:
        raise UserError(
            f"{folder}: expected depth images named after frames (NAME{_DEPTH_SUFFIX}), got {len(files)} of which none "
            "belongs to a keyframe."
        )
    return found


def read_depth_image(path: Path) -> np.ndarray:
    """Read a depth image, uint16 millimetres along the camera's z axis; return (H, W) float64 metres, NaN = missing.

    Raises
    ------
    UserError
        If the file is missing, cannot be decoded, or is not of one 16-bit channel.
    """
    image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED) if Path(path).is_file() else None
    if image is None:
        raise UserError(f"{path}: expected a depth image, found none that can be decoded; check the file.")
    if image.dtype != np.uint16 or image.ndim != 2:
        raise UserError(
            f"{path}: expected one channel of 16-bit millimetres, got {image.dtype} of shape {image.shape}."
        )
    return np.where(np.isin(image, _MISSING_DEPTHS), np.nan, image / 1000.0)
