"""From the masks of undistorted crops to those of the frames as they were filmed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import cv2
import numpy as np

from threedfs.frames.scale import scale_camera
from threedfs.geometry.lens import Lens
from threedfs.geometry.projection import pixel_grid
from threedfs.types import View


def distort_masks(
    masks: Mapping[str, np.ndarray],
    views: Mapping[str, View],
    whole: Mapping[str, View],
    distortion: tuple[float, float],
    source_shape: tuple[int, int],
) -> Iterator[tuple[str, np.ndarray]]:
    """Yield each mask (H, W) bool of a crop, by its name, as a mask (Hs, Ws) bool of its source frame.

    Each pixel of the source takes the value, interpolated and rounded, at the place that it shows; none is set outside
    of the crop.

    Parameters
    ----------
    masks : mapping of str to (H, W) bool
    views : mapping of str to View
        The crops.
    whole : mapping of str to View
        The whole undistorted frames, at any resolution.
    distortion : tuple of float
        (k1, k2), see `threedfs.geometry.distortion`.
    source_shape : tuple of int
        (Hs, Ws).
    """
    lens, ideal = None, np.empty(0)
    for name, mask in masks.items():
        view = views[name]
        own = Lens(scale_camera(whole[name].camera, source_shape, "mask"), *distortion)
        if own != lens:  # of a video all frames have one
            lens, ideal = own, own.normalise(np.stack(pixel_grid(own.camera), axis=-1))
        focal, principal = (view.camera.fx, view.camera.fy), (view.camera.cx, view.camera.cy)
        places = np.nan_to_num(ideal * focal + principal, nan=-1e4).astype(np.float32)
        shown = cv2.remap(mask.astype(np.float32), places[..., 0], places[..., 1], cv2.INTER_LINEAR)
        yield name, shown > 0.5
