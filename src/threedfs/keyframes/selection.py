"""The choice of keyframes: the sharpest frame of each viewing sector, spread around the scene."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from threedfs.locate.fixation import find_fixation
from threedfs.types import View


def viewing_directions(views: Sequence[View], xyz: np.ndarray) -> np.ndarray:
    """Return the unit directions (F, 3) from the point that all cameras look at to each camera.

    That point is nearest to all optical axes in the least-squares sense; where the axes are nearly parallel, the
    median of the points `xyz` (P, 3) decides.
    """
    outward = np.stack([view.centre for view in views]) - find_fixation(views, np.median(xyz, axis=0))
    return outward / np.linalg.norm(outward, axis=1, keepdims=True)


def choose_keyframes(
    sector: np.ndarray,
    directions: np.ndarray,
    sharpness: np.ndarray,
    forced: np.ndarray,
    count: int,
    max_gap: float,
) -> np.ndarray:
    """Choose keyframes so that the largest gap between viewing directions is filled first.

    Every sector offers its sharpest frame, so blur never drops a side; a sector with a forced frame is
    represented by it.

    Parameters
    ----------
    sector : (F,) int64
        Viewing sector of each frame.
    directions : (F, 3) float64
        Unit viewing directions.
    sharpness : (F,) float64
        Larger is sharper; compared only within a sector.
    forced : (F,) bool
        Frames that must be keyframes.
    count : int
        Number aimed at, forced ones included.
    max_gap : float
        Angle in degrees; frames are added beyond `count` while some offered frame is farther than this from every
        keyframe.

    Returns
    -------
    (K,) int64
        Frame numbers, ascending.
    """
    chosen = [int(frame) for frame in np.flatnonzero(forced)]
    offered = []
    for number in np.unique(sector):
        members = np.flatnonzero(sector == number)
        if not forced[members].any():
            offered.append(int(members[np.argmax(sharpness[members])]))
    if not chosen:
        chosen.append(offered.pop(int(np.argmax(sharpness[offered]))))
    while offered:
        nearest = np.max(directions[offered] @ directions[chosen].T, axis=1)
        farthest = int(np.argmin(nearest))
        gap = np.degrees(np.arccos(np.clip(nearest[farthest], -1, 1)))
        if len(chosen) >= count and gap <= max_gap:
            break
        chosen.append(offered.pop(farthest))
    return np.sort(np.array(chosen, np.int64))
