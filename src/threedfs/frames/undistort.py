"""Images without radial distortion (Section 3.1)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache

import cv2
import numpy as np

from threedfs.errors import UserError
from threedfs.geometry.lens import Lens
from threedfs.geometry.projection import pixel_grid
from threedfs.types import Camera

# cv2.INTER_CUBIC reads 2 pixels on either side: only inside this margin are all of them the image's own.
_FOOTPRINT = 1.0
_NOWHERE = -1e4  # a coordinate outside any image; cv2.remap must not be given NaN


def assign_cameras(names: Sequence[str], shape: tuple[int, int], cameras: Mapping[str, Camera]) -> list[Camera]:
    """Give every frame a camera: its own, or, without one, that of the frame nearest in the list that has one.

    Parameters
    ----------
    names : sequence of str
        All frames, in order.
    shape : tuple of int
        (rows, columns) of the frames.
    cameras : mapping of str to Camera
        Cameras of the posed frames.

    Raises
    ------
    UserError
        If no frame has a camera, or one is of another size than the frames.
    """
    posed = [place for place, name in enumerate(names) if name in cameras]
    if not posed:
        raise UserError("poses: expected the camera of at least one frame, got none; run the poses stage again.")
    for place in posed:
        camera = cameras[names[place]]
        if camera.shape != tuple(shape):
            raise UserError(
                f"camera of frame {names[place]}: expected {shape[1]}x{shape[0]} pixels like the frames, got "
                f"{camera.width}x{camera.height}; run the poses stage again."
            )
    nearest = np.abs(np.arange(len(names))[:, None] - np.array(posed)).argmin(axis=1)
    return [cameras[names[posed[choice]]] for choice in nearest]


def undistort_image(image: np.ndarray, camera: Camera, distortion: tuple[float, float]) -> np.ndarray:
    """Resample a raw frame to the pinhole camera with the same focal lengths and centre.

    Parameters
    ----------
    image : (H, W, 3) uint8
        Raw frame at the working resolution.
    camera : Camera
        Its camera, at that resolution.
    distortion : tuple of float
        (k1, k2), see `threedfs.geometry.distortion`.

    Returns
    -------
    (H, W, 3) uint8
        Bicubic; repeats the border where the raw frame shows nothing (see `valid_pixels`). Without distortion, the
        image itself.
    """
    if not any(distortion):
        return image
    columns, rows = _raw_from_ideal(camera, tuple(distortion))
    return cv2.remap(image, columns, rows, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)


def valid_pixels(camera: Camera, distortion: tuple[float, float]) -> np.ndarray:
    """Say which pixels (H, W) of an undistorted image are interpolated from pixels of the raw frame alone."""
    if not any(distortion):
        return np.ones(camera.shape, bool)
    columns, rows = _raw_from_ideal(camera, tuple(distortion))
    across = (columns >= _FOOTPRINT) & (columns <= camera.width - 1 - _FOOTPRINT)
    down = (rows >= _FOOTPRINT) & (rows <= camera.height - 1 - _FOOTPRINT)
    return across & down


@lru_cache(maxsize=2)
def _raw_from_ideal(camera, distortion):
    """Return where each undistorted pixel lies in the raw frame: columns and rows (H, W) float32."""
    ideal = Lens(camera).normalise(np.stack(pixel_grid(camera), axis=-1))
    raw = Lens(camera, *distortion).denormalise(ideal)
    return tuple(np.nan_to_num(raw[..., axis], nan=_NOWHERE).astype(np.float32) for axis in (0, 1))
