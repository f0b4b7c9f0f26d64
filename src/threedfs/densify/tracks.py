"""Which keyframes see which sparse points."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from threedfs.types import SparsePoints


def list_tracks(points: SparsePoints, frames: Sequence[int]) -> list[tuple[np.ndarray, list[int]]]:
    """List the sparse points that at least two of some frames see.

    Parameters
    ----------
    points : SparsePoints
    frames : sequence of int
        Frame numbers, as `points.track_frame` counts them.

    Returns
    -------
    list of ((3,) float64, list of int)
        A point, world, and the ranks among `frames` that see it, ascending.
    """
    rank = {frame: place for place, frame in enumerate(frames)}
    seen: dict[int, set[int]] = {}
    for point, frame in zip(points.track_point.tolist(), points.track_frame.tolist(), strict=True):
        if frame in rank:
            seen.setdefault(point, set()).add(rank[frame])
    return [(points.xyz[point], sorted(ranks)) for point, ranks in sorted(seen.items()) if len(ranks) > 1]
