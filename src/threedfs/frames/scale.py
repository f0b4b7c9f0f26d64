"""The working resolution, and cameras at another resolution."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np

from threedfs.errors import UserError
from threedfs.types import Camera


def working_shape(shape: tuple[int, int], longest_side: int) -> tuple[int, int]:
    """Return (rows, columns) shrunk so that the longer is at most `longest_side`; never enlarged.

    Examples
    --------
    >>> working_shape((1280, 720), 960)
    (960, 540)
    >>> working_shape((480, 640), 960)
    (480, 640)
    """
    factor = min(1.0, longest_side / max(shape))
    rows, columns = (max(1, round(length * factor)) for length in shape)
    return rows, columns


def shrink(image: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """Average an image (H, W, 3) down to `shape` (rows, columns), each new pixel over the area it covers."""
    if image.shape[:2] == tuple(shape):
        return image
    return cv2.resize(image, (shape[1], shape[0]), interpolation=cv2.INTER_AREA)


def scale_camera(camera: Camera, shape: tuple[int, int], what: str) -> Camera:
    """Return the camera of the same images at another resolution.

    With integer coordinates at pixel centres, u' = (u + 0.5) s - 0.5; s is taken for each axis, because rounding to
    whole pixels makes them differ a little.

    Parameters
    ----------
    shape : tuple of int
        New (rows, columns).
    what : str
        Where the camera came from, for the message.

    Raises
    ------
    UserError
        If the two resolutions differ in their aspect by more than rounding explains.
    """
    rows, columns = shape
    # Either resolution may have been rounded to whole pixels: half a pixel for each of the four sides.
    rounding = 0.5 * (rows + columns + camera.width + camera.height)
    if abs(camera.width * rows - camera.height * columns) > rounding:
        raise UserError(
            f"{what}: expected images of the aspect of the frames ({columns}x{rows} pixels), got "
            f"{camera.width}x{camera.height}; film the board with the same camera, mode and orientation."
        )
    across, down = columns / camera.width, rows / camera.height
    return replace(
        camera,
        width=columns,
        height=rows,
        fx=camera.fx * across,
        fy=camera.fy * down,
        cx=(camera.cx + 0.5) * across - 0.5,
        cy=(camera.cy + 0.5) * down - 0.5,
    )
