"""What the correction of a field would join, and the field holds apart."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import distance_transform_edt, label, maximum_filter, minimum_filter

_OUTSIDE = np.float32(1e-3)
"""Value of a voxel that is put back outside where the field itself was not known to be."""


def keep_apart(sdf: np.ndarray, corrected: np.ndarray, above: np.ndarray) -> np.ndarray:
    """Return the corrected field without the voxels by which solids of the field grow together.

    Differs from the paper, which corrects without looking at what becomes of the solids: lumps of table stand beside an
    object, a voxel or two away, and a surface that moves out on the whole takes some in.

    Parameters
    ----------
    sdf, corrected : (nx, ny, nz) float32
        The field before and after its correction, negative inside.
    above : (nx, ny, nz) bool
        Where solids count: over the support surface, which joins all.

    Returns
    -------
    (nx, ny, nz) float32
        Newly solid voxels that touch a voxel of another solid are outside again.
    """
    solid = (sdf < 0) & above
    labels, count = label(solid)
    if count < 2:
        return corrected
    grown = (corrected < 0) & above
    nearest = labels[tuple(distance_transform_edt(~solid, return_distances=False, return_indices=True))]
    highest = maximum_filter(np.where(grown, nearest, 0), 3)
    lowest = minimum_filter(np.where(grown, nearest, count + 1), 3)
    bridges = grown & ~solid & (highest != lowest)
    return np.where(bridges, np.maximum(sdf, _OUTSIDE), corrected).astype(np.float32)
