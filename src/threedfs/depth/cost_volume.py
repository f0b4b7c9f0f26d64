"""The photometric cost volume (Section 3.2, Eq. 1)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import cv2
import numpy as np

from threedfs.depth.zncc import MISSING, accumulate_cost, describe_patches
from threedfs.geometry.rigid import invert
from threedfs.types import View


def plane_homographies(reference: View, neighbour: View, depths: np.ndarray) -> np.ndarray:
    """Return (D, 3, 3) maps from reference pixels to neighbour pixels for the planes z = `depths` of the reference."""
    neighbour_from_reference = neighbour.cam_from_world @ invert(reference.cam_from_world)
    through_planes = np.tile(neighbour_from_reference[:3, :3], (len(depths), 1, 1))
    through_planes[:, :, 2] += neighbour_from_reference[:3, 3] / np.asarray(depths)[:, None]
    return neighbour.camera.px_from_cam @ through_planes @ np.linalg.inv(reference.camera.px_from_cam)


def choose_patch_radius(neighbour_angle: float) -> int:
    """Choose the patch radius by how far apart the views are: 1 up to 18 degrees, one more each 6 degrees, at most 4.

    Small patches are enough, and sharpest, where neighbours are close and many; across wide gaps between photos
    there are few neighbours, and small patches match by chance.

    Examples
    --------
    >>> choose_patch_radius(8.0), choose_patch_radius(20.0), choose_patch_radius(60.0)
    (1, 2, 4)
    """
    return int(np.clip(1 + np.ceil((neighbour_angle - 18) / 6), 1, 4))


def compute_cost_volume(
    reference: View,
    reference_grey: np.ndarray,
    neighbours: Sequence[View],
    read_grey: Callable[[View], np.ndarray],
    candidates: np.ndarray,
    *,
    patch_radius: int,
    variance_floor: float,
    missing_cost: float,
    track: Callable[[Iterable], Iterable] = iter,
) -> np.ndarray:
    """Average the photometric error of every pixel and depth candidate over the neighbours (Eq. 1).

    The neighbour's patch is taken through the fronto-parallel plane of the candidate, so that it covers the
    same part of that plane as the reference's.

    Parameters
    ----------
    reference : View
    reference_grey : (H, W) float32
        Centred grey levels, `MISSING` where the image shows nothing.
    neighbours : sequence of View
    read_grey : callable
        Gives a neighbour's grey image in the same form; one at a time is held.
    candidates : (D,) float64
        Depths, ascending, scene units.
    patch_radius : int
        1 for the paper's 3x3 patches.
    variance_floor : float
        Grey levels squared; see `describe_patches`.
    missing_cost : float
        Error charged where a neighbour does not see the patch: that of no correlation is 0.5.
    track : callable
        Wraps the loop over neighbours to report progress.

    Returns
    -------
    (D, H, W) float32 in [0, 1]

    Notes
    -----
    Differs from the paper: patches are compared through the candidate's plane, not axis by axis around the
    reprojected point, and variances have a floor. The paper does not say what a view that misses a pixel counts: here
    a neutral error, as leaving it out would favour depths that few views see.
    """
    height, width = reference_grey.shape
    patches = describe_patches(reference_grey, patch_radius, variance_floor)
    grey = np.where(reference_grey > MISSING / 2, reference_grey, np.float32(0))
    column, patch = np.empty((2, 3, width), np.float32)
    warped = np.empty((height, width), np.float32)
    cost = np.zeros((len(candidates), height, width), np.float32)
    for neighbour in track(neighbours):
        image = read_grey(neighbour)
        for plane_cost, neighbour_from_reference in zip(
            cost, plane_homographies(reference, neighbour, candidates), strict=True
        ):
            cv2.warpPerspective(
                image,
                neighbour_from_reference,
                (width, height),
                dst=warped,
                flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
                borderMode=cv2.BORDER_CONSTANT,
                borderValue=float(MISSING),
            )
            warped[_behind(neighbour_from_reference, height, width)] = MISSING
            accumulate_cost(
                warped,
                grey,
                patches.mean,
                patches.inverse_deviation,
                patch_radius,
                np.float32(variance_floor),
                np.float32(missing_cost),
                column,
                patch,
                plane_cost,
            )
    cost /= np.float32(len(neighbours))
    return cost


def _behind(homography: np.ndarray, height: int, width: int) -> np.ndarray | slice:
    """Return where the plane lies behind the neighbour, as an index; the third row of the map is its depth there."""
    row, column, constant = homography[2, 1], homography[2, 0], homography[2, 2]
    corners = [constant, constant + row * height, constant + column * width, constant + row * height + column * width]
    if min(corners) > 0:
        return np.s_[:0]
    return column * np.arange(width) + row * np.arange(height)[:, None] + constant <= 0
