"""Single images and masks."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from threedfs.errors import UserError
from threedfs.io.atomic import atomic

# Readers of depth images take this level, like 0, for none.
_NO_DEPTH = 65535


def read_image(path: Path) -> np.ndarray:
    """Read an image file as (H, W, 3) uint8 RGB, upright by its EXIF orientation.

    Raises
    ------
    UserError
        If the file is missing or cannot be decoded.
    """
    return np.ascontiguousarray(_decode(path, cv2.IMREAD_COLOR, "an image")[..., ::-1])


def write_png(path: Path, image: np.ndarray) -> None:
    """Write (H, W) uint8 or uint16, or (H, W, 3) RGB uint8, as PNG."""
    if image.ndim == 3:
        image = image[..., ::-1]
    done, data = cv2.imencode(".png", np.ascontiguousarray(image), [cv2.IMWRITE_PNG_COMPRESSION, 6])
    if not done:
        raise UserError(f"{path}: the image of shape {image.shape} could not be encoded as PNG.")
    with atomic(path) as temporary:
        temporary.write_bytes(data.tobytes())


def read_mask(path: Path) -> np.ndarray:
    """Read a mask (H, W) bool: true where the file is brighter than half.

    Raises
    ------
    UserError
        If the file is missing or cannot be decoded.
    """
    return _decode(path, cv2.IMREAD_GRAYSCALE, "a mask image") > 127


def write_mask(path: Path, mask: np.ndarray) -> None:
    """Write a mask (H, W) bool as PNG: 255 object, 0 background."""
    write_png(path, mask.astype(np.uint8) * 255)


def write_depth_image(path: Path, depth: np.ndarray, scale: float) -> None:
    """Write depth (H, W) as 16-bit PNG: times `scale`, rounded; 0 where it is not finite or too large."""
    levels = np.rint(np.nan_to_num(depth, nan=0.0, posinf=0.0) * scale)
    write_png(path, np.where(levels < _NO_DEPTH, levels, 0).astype(np.uint16))


def _decode(path: Path, mode: int, what: str) -> np.ndarray:
    image = cv2.imread(str(path), mode) if Path(path).is_file() else None
    if image is None:
        raise UserError(f"{path}: expected {what}, found none that can be decoded; check the file.")
    return image
