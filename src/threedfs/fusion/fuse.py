"""Fusing posed depth maps on a grid, one at a time."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from threedfs.errors import UserError
from threedfs.fusion.softmax import SoftMaximum
from threedfs.types import View

Vote = tuple[View, np.ndarray, np.ndarray | None, np.ndarray | None]
"""A view, its depth map (H, W), and its confidence and free depth or None (see `SoftMaximum.add`)."""


def fuse_views(votes: Iterable[Vote], fused: SoftMaximum) -> tuple[np.ndarray, np.ndarray]:
    """Fuse the depth maps of all views (3.3.1); never more than one is held.

    Returns
    -------
    sdf : (nx, ny, nz) float32
    seen : (nx, ny, nz) uint8

    Raises
    ------
    UserError
        If no view sees any voxel.
    """
    for vote in votes:
        fused.add(*vote)
    sdf, seen = fused.result()
    if not seen.any():
        raise UserError(
            "No keyframe with depth sees the region to be fused; expected the cameras to look at the sparse points; "
            "check that the poses belong to these frames."
        )
    return sdf, seen


def limit_clip_distance(clip_distance: float, thickness: float, share: float, spacing: float) -> float:
    """Return the clip distance in scene units, at most `share` of the object's thickness and at least 2 voxels.

    Parameters
    ----------
    clip_distance : float
        In voxels.
    thickness : float
        Of the object, scene units.
    share : float
    spacing : float
        Edge of a voxel, scene units.
    """
    return float(np.clip(share * thickness, 2 * spacing, max(clip_distance, 2) * spacing))
