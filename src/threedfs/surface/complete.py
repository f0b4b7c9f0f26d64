"""Confirmed depth completed by the hull of the masks: bounded by it, and filled where masks show more than depth."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import find_objects, gaussian_filter

from threedfs.fusion.softmax import SoftMaximum
from threedfs.hull.gaps import find_gaps
from threedfs.types import View

_GAP_BLUR = 1.0
"""Standard deviation, voxels, by which trust in the hull spreads around a gap, so that no edge is left there."""
_BLUR_ENDS = 4.0
"""Radius of that blur, standard deviations."""
_GAP_PEAK = 1.5
"""What that trust is multiplied by after it was blurred: inside of a gap a few voxels wide it is full again."""


@dataclass(frozen=True)
class HullRule:
    """What the hull of the masks counts against depth; `SurfaceParams` says more of each value."""

    hull_trust: float
    sure_hull_trust: float
    round_trust: float
    gap_views: int
    gap_share: float
    gap_odds: float


def complete_depth(
    fused: SoftMaximum,
    hull: np.ndarray,
    bound: np.ndarray,
    filler: np.ndarray,
    sureness: float,
    roundness: float,
    above: np.ndarray,
    masks: Mapping[str, np.ndarray],
    views: Mapping[str, View],
    rule: HullRule,
    threads: int = 1,
) -> np.ndarray:
    """Return the field (nx, ny, nz) float32 in [-1, 1] that agrees with depth and masks, negative inside the object.

    Not in the paper. The hull votes everywhere, the less, the surer the object's depth is, and the more, the rounder
    the object. Where masks then show more than is solid, it votes once more, there as much as depth that is trusted
    fully; and what is missing still is the hull's.

    Parameters
    ----------
    fused : SoftMaximum
        Holds the votes of all views' depth; stays as it is.
    hull, bound, filler : (nx, ny, nz) float32
        The hull that is weighed, the one that nothing leaves but what fills gaps, and the one that fills them
        (`measure_hull`, by more and more masks that may be wrong).
    sureness : float
        Of the object's depth, in [0, 1] (`rate_sureness`).
    roundness : float
        How far the object has no hollows but those that its masks show, in [0, 1] (`rate_roundness`).
    above : (nx, ny, nz) bool
        Voxels above the support plane, which may be filled.
    masks : mapping of str to (H, W) bool
    views : mapping of str to View
    rule : HullRule
    threads : int
        Changes no result.
    """

    shown = sum(masks[name].any() for name in views)
    least_views = max(rule.gap_views, round(rule.gap_share * shown))

    def gaps_of(field):
        solid = (field < 0) & above
        return find_gaps(solid, filler, above, masks, views, fused.grid, least_views, rule.gap_odds, threads)

    trust = (1 - sureness) * rule.hull_trust + sureness * rule.sure_hull_trust
    votes: list[tuple[np.ndarray, float | np.ndarray]] = [(hull, trust + roundness * (rule.round_trust - trust))]
    votes.append((hull, _trust_around(gaps_of(np.maximum(fused.result_with(votes), bound)))))
    field = np.maximum(fused.result_with(votes), bound)
    return np.where(gaps_of(field), np.minimum(field, filler), field)


def _trust_around(gaps: np.ndarray) -> np.ndarray:
    """Return the trust in the hull in and around gaps (nx, ny, nz) bool, (nx, ny, nz) float64 in [0, 1]."""
    trust = np.zeros(gaps.shape)
    if not gaps.any():
        return trust
    (box,) = find_objects(gaps.astype(np.uint8))
    reach = int(_BLUR_ENDS * _GAP_BLUR + 0.5)
    near = tuple(slice(max(part.start - reach, 0), part.stop + reach) for part in box)
    blurred = gaussian_filter(gaps[near].astype(np.float64), _GAP_BLUR, truncate=_BLUR_ENDS)
    np.clip(_GAP_PEAK * blurred, 0, 1, out=trust[near])
    return trust


def close_pits(field: np.ndarray, share: float) -> np.ndarray:
    """Return a field (nx, ny, nz) float32 whose pits and tunnels up to two voxels wide are closed by a share in [0, 1].

    Not in the paper. A grey-scale closing of the solid, by a voxel and the 6 beside it.
    """
    if share <= 0:
        return field
    closed = -_least_beside(-_least_beside(field))  # the least of each neighbourhood, then the largest of these
    return field + np.float32(share) * (closed - field)


def _least_beside(field: np.ndarray) -> np.ndarray:
    """Return the least of each value of a field (nx, ny, nz) and the 6 beside it."""
    least = field.copy()
    for axis in range(3):
        values, found = np.moveaxis(field, axis, 0), np.moveaxis(least, axis, 0)
        np.minimum(found[1:], values[:-1], out=found[1:])
        np.minimum(found[:-1], values[1:], out=found[:-1])
    return least
