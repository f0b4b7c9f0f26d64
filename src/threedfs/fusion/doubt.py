"""Mirror images of the support plane that would carve holes into a bare object."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from threedfs.locate.mirrored import believe_mirrored, find_mirrored
from threedfs.ramp import rise
from threedfs.types import Support, View

Vote = tuple[View, np.ndarray, np.ndarray, np.ndarray]
"""The view of a keyframe, its depth map, confidence and free depth, all (H, W) float32, as `read_votes` yields them."""


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

    The mean is over all pixels of all views that show the object, also those without depth; 1 if there are none.

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
    return float(rise(total / pixels, rule.mirrored_from, rule.mirrored_full)) if pixels else 1.0


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
        As it returns it. Mirror images tell only of that share of their rays that it is free.
    """
    for view, depth, confidence, free_depth in votes:
        mirrored = find_mirrored(view, shown[view.name], depth, support, rule.mirrored_height)
        free = np.where(mirrored, np.float32(sureness) * np.minimum(free_depth, depth), free_depth)
        yield view, depth, confidence * believe_mirrored(mirrored, sureness), free
