"""First labels of voxels and superpixels, and which of them are fixed (Sections 3.4.2, 3.4.3)."""

from __future__ import annotations

import numpy as np
from scipy import ndimage

from threedfs.segment.energy import BACKGROUND, EMPTY, OBJECT
from threedfs.segment.superpixels import Superpixels

UNDECIDED = 255


def normalised_height(height: np.ndarray) -> np.ndarray:
    """Return the normalised distance of voxels from the support plane, in (0, 1), 0.5 on it (Eq. 24).

    Differs from the paper: the spread that it is normalised by is that of the grid, by default the object's own, which
    reaches less far below the plane than the paper's region of interest.

    Parameters
    ----------
    height : (nx, ny, nz) float32
        Signed distance from the plane.
    """
    return (1 / (1 + np.exp(-height / height.std()))).astype(np.float32)


def fix_voxels(sdf: np.ndarray, normalised: np.ndarray, *, empty_level: float, deepest: float) -> np.ndarray:
    """Return the voxels' fixed labels (nx, ny, nz) uint8: far below the plane, and in empty space for certain.

    Voxels that no view sees have the field of empty space, and are fixed as such.

    Parameters
    ----------
    sdf : (nx, ny, nz) float32
    normalised : (nx, ny, nz) float32
        `normalised_height`.
    empty_level : float
        Fields above it are empty (paper: 0.9).
    deepest : float
        Normalised heights below it are background (paper: 0.3).

    Returns
    -------
    (nx, ny, nz) uint8
        `UNDECIDED` where a voxel is open.
    """
    fixed = np.full(sdf.shape, UNDECIDED, np.uint8)
    fixed[sdf > empty_level] = EMPTY
    fixed[normalised < deepest] = BACKGROUND
    return fixed


def first_voxel_labels(sdf: np.ndarray, component: np.ndarray, fixed: np.ndarray) -> np.ndarray:
    """Return first labels (nx, ny, nz) uint8: the object's component, other solids background, the rest empty.

    Differs from the paper: it marks voxels with a semi-dense point as object, and all others above the plane empty.
    """
    labels = np.where(sdf < 0, BACKGROUND, EMPTY).astype(np.uint8)
    labels[component & (sdf < 0)] = OBJECT
    return np.where(fixed == UNDECIDED, labels, fixed)


def bound_object(sdf: np.ndarray, guess: np.ndarray, high: np.ndarray, level: float, margin: int) -> np.ndarray:
    """Return an over-estimate of the object, (nx, ny, nz) bool.

    Differs from the paper: it is the piece with the object in it, not the largest one, and holds all within `margin`
    voxels of the object, so that what fusion lost can come back.

    Parameters
    ----------
    sdf : (nx, ny, nz) float32
    guess : (nx, ny, nz) bool
        The object in the fused field.
    high : (nx, ny, nz) bool
        Where the field's level counts: above the support.
    level : float
        The piece's field is below it (paper: 0.5).
    margin : int
        Voxels (paper: 0).
    """
    labels, _ = ndimage.label((sdf < level) & high)
    inside = labels[guess & (labels > 0)]
    outer = guess if len(inside) == 0 else guess | (labels == np.bincount(inside).argmax())
    return outer if margin == 0 else outer | (ndimage.distance_transform_edt(~guess) <= margin)


def decide_superpixels(superpixels: Superpixels, outer: np.ndarray, inner: np.ndarray, share: float) -> np.ndarray:
    """Return each superpixel's fixed label (count,) uint8 by the trimap, `UNDECIDED` in the band between.

    Parameters
    ----------
    superpixels : Superpixels
    outer, inner : (H, W) bool
        Silhouettes of the over- and the under-estimate.
    share : float
        Share of its pixels outside the one, or inside the other, that decides a superpixel (paper: 0.9).
    """
    decided = np.full(superpixels.count, UNDECIDED, np.uint8)
    decided[superpixels.share(inner) > share] = OBJECT
    decided[superpixels.share(~outer) > share] = BACKGROUND
    return decided
