"""Depth of the keyframes, with what it is worth."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from threedfs.fusion.softmax import SoftMaximum
from threedfs.types import View


@dataclass(frozen=True)
class ConfirmedDepth:
    """The depth maps of the keyframes, how far they are trusted, and their votes on a grid.

    Attributes
    ----------
    fused : SoftMaximum
        Holds the votes of all views.
    clip_distance : float
        Of those votes, scene units.
    sureness : float
        Of the object's depth, in [0, 1] (`rate_sureness`).
    views : mapping of str to View
    trust : mapping of str to (H, W) float32
        In [0, 1] (`trust_depth`).
    read : callable
        Gives the depth map (H, W) of a view by its name, NaN where it has none.
    threads : int
        Cores used; no result depends on it.
    """

    fused: SoftMaximum
    clip_distance: float
    sureness: float
    views: Mapping[str, View]
    trust: Mapping[str, np.ndarray]
    read: Callable[[str], np.ndarray]
    threads: int = 1
