"""From the mask of an undistorted crop to that of the frame as it was filmed."""

from __future__ import annotations

import cv2
import numpy as np

from threedfs.frames.scale import scale_camera
from threedfs.geometry.lens import Lens
from threedfs.geometry.projection import pixel_grid
from threedfs.types import Camera


def distort_mask(
    mask: np.ndarray,
    camera: Camera,
    whole: Camera,
    distortion: tuple[float, float],
    source_shape: tuple[int, int],
) -> np.ndarray:
    """Return a mask (H, W) bool of a crop as a mask (Hs, Ws) bool of its source frame.

    Each pixel of the source takes the value, interpolated and rounded, at the place that it shows; none is set outside
    of the crop.

    Parameters
    ----------
    mask : (H, W) bool
    camera : Camera
        Of the crop.
    whole : Camera
        Of the whole undistorted frame, at any resolution.
    distortion : tuple of float
        (k1, k2), see `threedfs.geometry.distortion`.
    source_shape : tuple of int
        (Hs, Ws).
    """
    lens = Lens(scale_camera(whole, source_shape, "mask"), *distortion)
    ideal = lens.normalise(np.stack(pixel_grid(lens.camera), axis=-1))
    places = np.nan_to_num(ideal * (camera.fx, camera.fy) + (camera.cx, camera.cy), nan=-1e4).astype(np.float32)
    return cv2.remap(mask.astype(np.float32), places[..., 0], places[..., 1], cv2.INTER_LINEAR) > 0.5
