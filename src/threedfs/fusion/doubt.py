"""Mirror images of the support plane that would carve holes into a bare object."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from threedfs.locate.mirrored import believe_mirrored, find_mirrored
from threedfs.ramp import rise
from threedfs.types import Support, View

Vote = tuple[View, np.ndarray, np.ndarray, np.ndarray]
"""The view, depth map, confidence and free depth of a keyframe."""


@dataclass(frozen=True)
class DoubtRule:
    """Which depth is taken for a mirror image, and when it is believed all the same.

    Attributes
    ----------
    mirrored_height : float
        Share of the object's height, as `find_mirrored` takes it.
    mirrored_from, mirrored_full : float
        Mean confidence in the object's depth up to which mirror images are not believed, and from which they are.
    """

    mirrored_height: float
    mirrored_from: float
    mirrored_full: float


def rate_shown(votes: Iterable[Vote], shown: Mapping[str, np.ndarray], support: Support, rule: DoubtRule) -> float:
    """Return how sure the object's depth is, in [0, 1], by the mean confidence in it but for mirror images.

    Parameters
    ----------
    votes : iterable of Vote
    shown : mapping of str to (H, W) bool
        Where each keyframe shows the object, about.
    support : Support
    rule : DoubtRule
    """
    total = pixels = 0.0
    for view, depth, confidence, _ in votes:
        own = shown[view.name] & ~find_mirrored(view, shown[view.name], depth, support, rule.mirrored_height)
        total += float(confidence[own].sum(dtype=np.float64))
        pixels += int(own.sum())
    return float(rise(total / max(pixels, 1), rule.mirrored_from, rule.mirrored_full))


def doubt_mirrored(
    votes: Iterable[Vote], shown: Mapping[str, np.ndarray], support: Support, rule: DoubtRule, sureness: float
) -> Iterator[Vote]:
    """Yield votes whose mirror images count as far as the object's depth is sure.

    Not in the paper. The finer an image, the better does the plane's image in a glossy side match, so that the fine
    field loses sides that the coarse one has.

    Parameters
    ----------
    votes, shown, support, rule
        As `rate_shown` takes them.
    sureness : float
        As it returns it. Below a half mirror images do not say that the space before them is free, either.
    """
    for view, depth, confidence, free_depth in votes:
        mirrored = find_mirrored(view, shown[view.name], depth, support, rule.mirrored_height)
        blind = mirrored & (sureness < 0.5)
        yield (
            view,
            depth,
            confidence * believe_mirrored(mirrored, sureness),
            np.where(blind, np.float32(0), free_depth),
        )
