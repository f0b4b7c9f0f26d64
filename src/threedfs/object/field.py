"""The object's own signed distance field: cut by the support plane, everything else made empty."""

from __future__ import annotations

import numpy as np
from scipy import ndimage


def mask_field(sdf: np.ndarray, owned: np.ndarray, height: np.ndarray, spacing: float, medians: int = 0) -> np.ndarray:
    """Return the field of the object alone, (nx, ny, nz) float32, negative inside it and nowhere else (Sec. 3.5).

    Outside the object the field is set to 1 where it is negative. The support plane cuts the object: below, the field
    is the distance to the plane in voxels.

    Differs from the paper: outside the object the field stays where it is positive, so that the zero level keeps
    its place between voxels; the paper sets all of it to 1, which moves the surface to the voxel centres. The
    paper has no cut by the plane, its labels end there, and no median. The mesh smoothing of Section 3.5 is not
    applied here.

    Parameters
    ----------
    sdf : (nx, ny, nz) float32
    owned : (nx, ny, nz) bool
        Voxels of the object.
    height : (nx, ny, nz) float32
        Above the plane, scene units.
    spacing : float
        Edge of a voxel, scene units.
    medians : int
        How many times a value becomes the median of its own and its 6 neighbours' before the plane cuts: pits, spikes
        and handles a voxel or two wide go, edges and corners stay.
    """
    alone = np.where((sdf < 0) & ~owned, np.float32(1), sdf).astype(np.float32)
    if medians and owned.any():
        (box,) = ndimage.find_objects(owned.astype(np.uint8))
        near = tuple(slice(max(part.start - 2, 0), part.stop + 2) for part in box)
        beside = ndimage.generate_binary_structure(3, 1)
        for _ in range(medians):
            alone[near] = ndimage.median_filter(alone[near], footprint=beside, mode="nearest")
    standing = np.where(height <= 0, sdf, alone)  # what the object stands on does not lift its foot off the plane
    return np.maximum(standing, np.clip(-height / spacing, -1, 1)).astype(np.float32)
