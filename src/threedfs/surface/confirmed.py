"""Depth of the keyframes, with what it is worth."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from threedfs.fusion.softmax import SoftMaximum, facing_cosine
from threedfs.geometry.projection import backproject_map
from threedfs.hull.inside import HullInside
from threedfs.locate.mirrored import believe_mirrored, find_mirrored
from threedfs.read_ahead import map_ahead
from threedfs.surface.adopt import AdoptRule, LentDepth, adopt_depth, lend_depth
from threedfs.surface.keyframe_depth import KeyframeDepth
from threedfs.surface.trust import (
    TrustRule,
    rate_roundness,
    rate_sureness,
    share_matched,
    trust_aslant,
    trust_depth,
    trust_free,
)
from threedfs.types import Support, View


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
    roundness : float
        How far the object has no hollows but those that its masks show, in [0, 1] (`rate_roundness`).
    views : mapping of str to View
    trust : mapping of str to (H, W) float32
        In [0, 1] (`trust_depth`, `believe_mirrored`).
    read : callable
        Gives the depth map (H, W) of a view by its name, NaN where it has none.
    threads : int
        Cores used; no result depends on it.
    """

    fused: SoftMaximum
    clip_distance: float
    sureness: float
    roundness: float
    views: Mapping[str, View]
    trust: Mapping[str, np.ndarray]
    read: Callable[[str], np.ndarray]
    threads: int = 1


def confirm_depth(
    views: Mapping[str, View],
    read: Callable[[str], KeyframeDepth],
    start: Callable[[float], tuple[SoftMaximum, float]],
    support: Support,
    inside: HullInside,
    trust: TrustRule,
    adopt: AdoptRule,
    *,
    track: Callable[[Iterable], Iterable] = iter,
    threads: int = 1,
) -> ConfirmedDepth:
    """Fuse depth maps whose pixels count by how well they are confirmed.

    Not in the paper.

    Parameters
    ----------
    views : mapping of str to View
        Of the keyframes.
    read : callable
        Gives what is known of a keyframe's depth by its name; few are held at a time.
    start : callable
        Gives votes to add to, still empty, and their clip distance in scene units, by the sureness of the object's
        depth.
    support : Support
        Where the object stands.
    inside : HullInside
        Of the hull of the masks.
    trust : TrustRule
    adopt : AdoptRule
    track : callable
        Wraps the loop over keyframes to report progress.
    threads : int
        Cores used; the result does not depend on it.
    """
    first = dict(
        zip(views, map_ahead(lambda name: _look(read(name), inside, trust, adopt), views, threads=threads), strict=True)
    )
    own = {name: look.trust for name, look in first.items()}
    sureness = rate_sureness(own.values(), (look.mask for look in first.values()), trust)
    agreed, deep = sum(look.agreed for look in first.values()), sum(look.deep for look in first.values())
    roundness = rate_roundness(agreed, deep, sureness, trust)

    def adopt_of(name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        found = read(name)
        others = (look.lent for other, look in first.items() if other != name)
        near = _match(found, sureness, trust)
        depth = adopt_depth(found, near, others, adopt)
        return depth, near, trust_depth(found.agree, found.confidence, near, trust, 1 - roundness)

    adopted: dict[str, np.ndarray] = {}
    matched: dict[str, np.ndarray] = {}
    for name, found in zip(views, map_ahead(adopt_of, views, threads=threads), strict=True):
        adopted[name], matched[name], own[name] = found
    fused, clip_distance = start(sureness)
    final: dict[str, np.ndarray] = {}

    def vote_of(name: str):
        found, depth = read(name), adopted[name]
        believed = trust_aslant(own[name], found.agree, facing_cosine(found.view.camera, depth), trust)
        free = trust_free(believed, found.too_far, matched[name], len(views), sureness, trust)
        mirrored = find_mirrored(found.view, found.mask, found.depth, support, trust.mirrored_height)
        share = believe_mirrored(mirrored, sureness)
        final[name] = own[name] * share
        return found.view, depth, believed * share, None, free * share

    fused.add_all(vote_of(name) for name in track(views))
    return ConfirmedDepth(fused, clip_distance, sureness, roundness, views, final, adopted.__getitem__, threads)


@dataclass(frozen=True)
class _FirstLook:
    """What a depth map tells before it is known how sure the object's depth is.

    Attributes
    ----------
    trust : (H, W) float32
        In it, as of a bare object (`trust_depth`).
    mask : (H, W) bool
        Where the object is.
    lent : LentDepth
        To other maps.
    agreed, deep : int
        Pixels of the object whose depth lies well inside the hull: those that enough views agree on, and all.
    """

    trust: np.ndarray
    mask: np.ndarray
    lent: LentDepth
    agreed: int
    deep: int


def _look(found: KeyframeDepth, inside: HullInside, trust: TrustRule, adopt: AdoptRule) -> _FirstLook:
    own = trust_depth(found.agree, found.confidence, _match(found, 0.0, trust), trust)
    shown = found.mask & np.isfinite(found.depth)
    deep = inside.holds(backproject_map(found.view, found.depth)[shown])
    agreed = found.agree[shown][deep] >= trust.hollow_agree
    return _FirstLook(own, found.mask, lend_depth(found, adopt), int(agreed.sum()), len(agreed))


def _match(found: KeyframeDepth, sureness: float, trust: TrustRule) -> np.ndarray:
    return share_matched(found.photometric, found.mask, trust.matched_reach * found.length, trust, sureness)
