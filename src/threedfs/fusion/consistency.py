"""How well each depth map agrees with the others, pixel by pixel."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numba import njit, prange

from threedfs.geometry.transfer import px_from_px, transfer
from threedfs.threads import use_threads
from threedfs.types import View

_BLOCK = 8  # depth maps that are compared with each other one read: they and their counts are in memory


@dataclass(frozen=True)
class Agreement:
    """What the other views say of one depth map.

    Attributes
    ----------
    agree : (H, W) uint8
        Views whose depth surface passes through the pixel's point, and that have none on its ray in front of it.
    too_near : (H, W) uint8
        Views that see through the pixel's point to a surface behind it: it lies in their free space.
    too_far : (H, W) uint8
        Views with a surface on the pixel's ray in front of its point, which the pixel looks through.
        A surface of another view behind the point is hidden by it and says nothing.
    free_depth : (H, W) float32
        Depth of the nearest such surface, less the tolerance; infinity where there is none.
    """

    agree: np.ndarray
    too_near: np.ndarray
    too_far: np.ndarray
    free_depth: np.ndarray

    @property
    def share(self) -> np.ndarray:
        """Share of agreeing views among those that say anything, (H, W) float64; 0 where none does."""
        agree = self.agree.astype(np.float64)
        return agree / np.maximum(agree + self.too_near + self.too_far, 1)


@dataclass(frozen=True)
class ComparisonRule:
    """How depth maps are compared.

    Attributes
    ----------
    tolerance : float
        Relative difference in depth up to which two surfaces are the same.
    max_views : int
        Each map is compared with at most so many others, those whose optical axes are nearest in direction.
    witness_share : float
        Share of agreement from which a pixel's surface may speak against other views.
    """

    tolerance: float
    max_views: int
    witness_share: float


def check_consistency(
    views: Sequence[View], read_depth: Callable[[int], np.ndarray], rule: ComparisonRule, threads: int = 1
) -> Iterator[Agreement]:
    """Compare every depth map with those of the other views; yield the result of each in order.

    Compares twice: first to learn which surfaces other views confirm, then counting as contradictions only those
    by such surfaces. Depth without ground, as on a surface without texture, thus speaks against no one.

    At most nine depth maps are held at a time, and one bit per pixel of every map.

    Parameters
    ----------
    views : sequence of View
        Their images may differ in size.
    read_depth : callable
        Gives the depth map (H, W), NaN where missing, of a view by its rank.
    rule : ComparisonRule
    threads : int
        Cores used; the result does not depend on it.
    """
    first = compare_depth(views, read_depth, lambda rank: np.ones(views[rank].camera.shape, bool), rule, threads)
    witnesses = [np.packbits(agreement.share >= rule.witness_share) for agreement in first]

    def may_contradict(rank: int) -> np.ndarray:
        shape = views[rank].camera.shape
        return np.unpackbits(witnesses[rank], count=shape[0] * shape[1]).reshape(shape).astype(bool)

    yield from compare_depth(views, read_depth, may_contradict, rule, threads)


def compare_depth(
    views: Sequence[View],
    read_depth: Callable[[int], np.ndarray],
    may_contradict: Callable[[int], np.ndarray],
    rule: ComparisonRule,
    threads: int = 1,
    targets: Sequence[int] | None = None,
) -> Iterator[Agreement]:
    """Compare every depth map once with those of the other views; as `check_consistency`.

    Parameters
    ----------
    may_contradict : callable
        Gives, by the rank of a view, the pixels (H, W) bool whose surfaces may speak against others.
    targets : sequence of int
        Ranks of the views whose maps are compared; all by default.
    """
    use_threads(threads)
    partners = _nearest_views(views, rule.max_views)
    wanted = range(len(views)) if targets is None else targets
    # Maps of different sizes are compared on one canvas, beyond whose own part a map knows nothing.
    canvas = tuple(np.max([view.camera.shape for view in views], axis=0)) if views else (0, 0)
    for start in range(0, len(wanted), _BLOCK):
        block = np.asarray(wanted[start : start + _BLOCK])
        depth = np.stack([_extend(read_depth(i), canvas, np.nan) for i in block]).astype(np.float32)
        near_depth = np.stack([_local_minimum(item) for item in depth])
        counts = np.zeros((3, *depth.shape), np.uint8)
        free = np.full(depth.shape, np.inf, np.float32)
        for other in sorted(set().union(*(partners[i] for i in block))):
            seen = _extend(np.asarray(read_depth(other), np.float32), canvas, np.nan)
            _compare(
                depth,
                near_depth,
                seen,
                _local_minimum(seen),
                _extend(may_contradict(other), canvas, False),
                np.stack([px_from_px(views[other], views[i]) for i in block]),
                np.stack([px_from_px(views[i], views[other]) for i in block]),
                np.array([other in partners[i] for i in block]),
                rule.tolerance,
                counts,
                free,
            )
        for slot, rank in enumerate(block):
            own = tuple(slice(0, length) for length in views[rank].camera.shape)
            yield Agreement(*(count[slot][own] for count in counts), free[slot][own])


def count_agreeing(
    views: Sequence[View], read_depth: Callable[[int], np.ndarray], rank: int, *, tolerance: float, max_views: int
) -> np.ndarray:
    """Count the views whose depth maps have a surface where that of one view has one.

    Parameters
    ----------
    views, read_depth
        As for `compare_depth`.
    rank : int
        The one view.
    tolerance : float
        Relative difference in depth up to which two surfaces are the same.
    max_views : int
        It is compared with at most so many others, those whose optical axes are nearest in direction.

    Returns
    -------
    (H, W) uint8
    """
    rule = ComparisonRule(tolerance, max_views, 0.0)

    def silent(other: int) -> np.ndarray:
        return np.zeros(views[other].camera.shape, bool)

    (agreement,) = compare_depth(views, read_depth, silent, rule, targets=[rank])
    return agreement.agree


def rate_confidence(
    agreement: Agreement, photometric: np.ndarray, *, prior_views: float, full_share: float
) -> np.ndarray:
    """Turn the counts of a depth map into trust, (H, W) float32 in [0, 1].

    The share of agreeing views among those that say anything, with the photometric confidence as the opinion
    of `prior_views` more, reaches trust 1 at `full_share`.

    Parameters
    ----------
    agreement : Agreement
    photometric : (H, W) float in [0, 1]
        Confidence of the depth map by its own images (3.2, Eq. 11).
    prior_views : float
        Weight of the photometric confidence, in views.
    full_share : float
        Share of agreement from which a pixel is trusted fully.
    """
    agree = agreement.agree.astype(np.float64)
    heard = agree + agreement.too_near + agreement.too_far
    share = (agree + prior_views * np.nan_to_num(photometric)) / (heard + prior_views)
    return np.minimum(1.0, share / full_share).astype(np.float32)


def _nearest_views(views: Sequence[View], count: int) -> list[set[int]]:
    axes = np.stack([view.cam_from_world[2, :3] for view in views])
    cosines = axes @ axes.T
    np.fill_diagonal(cosines, -np.inf)
    order = np.argsort(-cosines, axis=1, kind="stable")[:, : min(count, len(views) - 1)]
    return [set(row.tolist()) for row in order]


def _extend(values: np.ndarray, shape: tuple[int, int], missing: float | bool) -> np.ndarray:
    """Return a map (H, W) on a canvas of at least its size, `missing` beyond it."""
    if values.shape == shape:
        return values
    canvas = np.full(shape, missing, values.dtype)
    canvas[: values.shape[0], : values.shape[1]] = values
    return canvas


def _local_minimum(depth: np.ndarray) -> np.ndarray:
    """Least depth in 3x3: a point beside a silhouette is not in front of the background it is rounded onto."""
    known = np.where(np.isnan(depth), np.float32(np.inf), depth)
    return cv2.erode(known, np.ones((3, 3), np.uint8), borderType=cv2.BORDER_REPLICATE)


@njit(cache=True, parallel=True)
def _compare(
    depth, near_depth, other_depth, other_near_depth, other_speaks, there, back, wanted, tolerance, counts, free
):
    rows, columns = other_depth.shape
    for slot in prange(depth.shape[0]):  # a target is the work of one thread, so scattered minima have no race
        if not wanted[slot]:
            continue
        rendered = np.full((rows + 2, columns + 2), np.inf, np.float32)  # the other view's surface, with a border
        agrees = np.zeros((rows, columns), np.uint8)
        for row in range(rows):
            for column in range(columns):
                u, v, z = transfer(there[slot], column, row, depth[slot, row, column])
                if u > -0.5 and v > -0.5 and u < columns - 0.5 and v < rows - 0.5:
                    other_row, other_column = int(v + 0.5), int(u + 0.5)
                    seen = other_depth[other_row, other_column]
                    if abs(z - seen) <= tolerance * z:
                        agrees[row, column] = 1
                    elif (
                        other_speaks[other_row, other_column]
                        and seen > 0
                        and z < (1 - tolerance) * other_near_depth[other_row, other_column]
                    ):
                        counts[1, slot, row, column] += 1
                if not other_speaks[row, column]:
                    continue
                u, v, z = transfer(back[slot], column, row, other_depth[row, column])
                if u > -0.5 and v > -0.5 and u < columns - 0.5 and v < rows - 0.5:
                    own_row, own_column = int(v + 0.5) + 1, int(u + 0.5) + 1
                    rendered[own_row, own_column] = min(rendered[own_row, own_column], z)
        # Nearest in 3x3, because points drawn one by one leave gaps; of each row first.
        for row in range(rows + 2):
            left, middle = rendered[row, 0], rendered[row, 1]
            for column in range(columns):
                right = rendered[row, column + 2]
                rendered[row, column] = min(left, middle, right)
                left, middle = middle, right
        for row in range(rows):
            for column in range(columns):
                if not depth[slot, row, column] > 0:
                    continue
                crossing = min(rendered[row, column], rendered[row + 1, column], rendered[row + 2, column])
                if crossing < (1 - tolerance) * near_depth[slot, row, column]:
                    counts[2, slot, row, column] += 1
                    free[slot, row, column] = min(free[slot, row, column], (1 - tolerance) * crossing)
                else:  # a point that the other view has a surface before agrees with it by chance
                    counts[0, slot, row, column] += agrees[row, column]
