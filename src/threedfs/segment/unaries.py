"""What each superpixel and each voxel costs under each label (Section 3.4.3, Eqs. 21 to 27)."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from threedfs.read_ahead import map_ahead
from threedfs.segment.energy import BACKGROUND, EMPTY, OBJECT
from threedfs.segment.lookup import find_pixels
from threedfs.segment.outline import depth_inside
from threedfs.types import View


def mean_by(values: np.ndarray, owner: np.ndarray, count: int) -> np.ndarray:
    """Return the mean of values (N,) over the members of each owner 0..count-1, 0 without members."""
    return np.bincount(owner, values, count) / np.maximum(np.bincount(owner, minlength=count), 1)


def silhouette_unary(share: np.ndarray) -> np.ndarray:
    """Return the cost (count, 2) of background and object where a silhouette covers a share (count,) (Eq. 23)."""
    return np.stack([share, 1 - share], axis=1)


def soften_silhouette(silhouette: np.ndarray, reach: float) -> np.ndarray:
    """Return the share (H, W) float64 in [0, 1] to which each pixel lies inside a silhouette (H, W) bool.

    Not in the paper: it rises from 0 to 1 over `reach` pixels to both sides of the outline, as fusion knows the outline
    no better than that, but what lies farther inside or outside well. With a reach of 0 it is the silhouette.
    """
    if reach <= 0 or not silhouette.any() or silhouette.all():
        return silhouette.astype(np.float64)
    return np.clip(0.5 + depth_inside(silhouette).astype(np.float64) / (2 * reach), 0, 1)


def sdf_unary(sdf: np.ndarray) -> np.ndarray:
    """Return the cost (N, 3) of background, object and empty in a field (N,), negative inside (Eq. 25)."""
    return np.stack([sdf, sdf, -sdf], axis=1)


def scene_unary(normalised: np.ndarray) -> np.ndarray:
    """Return the cost (N, 3) of labels on the wrong side of the support plane, by normalised height (Eq. 26)."""
    below = (normalised < 0.5) * (1 - normalised)
    above = (normalised > 0.5) * normalised
    cost = np.empty((len(normalised), 3), np.float32)
    cost[:, BACKGROUND], cost[:, OBJECT], cost[:, EMPTY] = above, below, below
    return cost


def carve_unary(
    centres: np.ndarray,
    views: Mapping[str, View],
    masks: Mapping[str, np.ndarray],
    valid: Mapping[str, np.ndarray],
    tolerance: float,
    threads: int = 1,
) -> np.ndarray:
    """Return the cost (N,) of the label object at voxels that project outside the object's masks (Eq. 27).

    Differs from the paper: a voxel is carved if more than a share `tolerance` of the views that show it project it
    outside (paper: any); views that do not show it, as it leaves their image or its valid part, say nothing.

    Parameters
    ----------
    centres : (N, 3) float64
        World.
    views : mapping of str to View
    masks, valid : mapping of str to (H, W) bool
        The object, and pixels that show the scene.
    tolerance : float
    threads : int
        Cores used; the result does not depend on it.
    """
    outside, shown = np.zeros(len(centres), np.int32), np.zeros(len(centres), np.int32)

    def look(name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        row, column, kept = find_pixels(views[name], centres)
        return kept, valid[name][row, column], (valid[name] & ~masks[name])[row, column]

    for kept, is_shown, is_outside in map_ahead(look, views, threads=threads):
        shown[kept] += is_shown
        outside[kept] += is_outside
    return (outside > tolerance * shown).astype(np.float32)
