"""How far a depth map is to be believed where it leaves the hull of the masks."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from threedfs.blur import blur
from threedfs.ramp import rise

_BARE, _SURE = 0.2, 0.6
"""Sureness up to which space is no freer than its depth is trusted, and from which depth says all it can of it."""


@dataclass(frozen=True)
class TrustRule:
    """When depth counts as confirmed; `SurfaceParams` says more of each value."""

    agree_from: float
    agree_full: float
    matched: float
    bare_matched: float
    matched_reach: float
    matched_from: float
    matched_full: float
    sure_from: float
    sure_full: float
    free_contradicted: float
    free_from: float
    free_full: float
    free_textured: float
    textured_from: float
    textured_full: float
    aslant_agree_from: float
    aslant_agree_full: float
    aslant_from: float
    aslant_full: float
    mirrored_height: float
    hollow_agree: float
    round_full: float
    round_until: float


def share_matched(
    photometric: np.ndarray, mask: np.ndarray, reach: float, rule: TrustRule, sureness: float = 0.0
) -> np.ndarray:
    """Return the share of an object's pixels around each whose photographs match, (H, W) float32 in [0, 1].

    Not in the paper.

    Parameters
    ----------
    photometric : (H, W) float32
        Confidence of the depth by the keyframe's own photographs (3.2, Eq. 11).
    mask : (H, W) bool
        The object: matches on what surrounds it say nothing of it.
    reach : float
        Standard deviation of the neighbourhood, pixels.
    rule : TrustRule
    sureness : float
        Of the object's depth, in [0, 1] (`rate_sureness`); a mirror image matches, too, but seldom as well as a
        texture does, so on a bare object matches must be better.
    """
    inside = mask.astype(np.float32)
    least = rule.bare_matched + sureness * (rule.matched - rule.bare_matched)
    matched = blur((photometric > least) * inside, reach)
    return matched / np.maximum(blur(inside, reach), np.float32(1e-3))


def trust_depth(
    agree: np.ndarray, confidence: np.ndarray, matched: np.ndarray, rule: TrustRule, hollows: float = 1.0
) -> np.ndarray:
    """Return the trust in a depth map, (H, W) float32 in [0, 1], by what other views and photographs say of it.

    Not in the paper. Depth is trusted that many views have found too; or, as few views see into a hollow, that none
    contradicts and that lies among pixels whose photographs match. On a bare face a few views agree on a wrong depth,
    and the share of agreement among those that say anything is high; but no photograph confirms it far and wide.

    Parameters
    ----------
    agree : (H, W) uint8
        Views that have a surface where the pixel has it (`Agreement`).
    confidence : (H, W) float32
        Share of agreement, in [0, 1] (`rate_confidence`).
    matched : (H, W) float32
        Share of matches around (`share_matched`).
    rule : TrustRule
    hollows : float
        How far depth is trusted that few views see, in [0, 1] (1 less `rate_roundness`).
    """
    seen = rise(agree.astype(np.float64), rule.agree_from, rule.agree_full)
    hidden = hollows * rise(matched, rule.matched_from, rule.matched_full) * confidence
    return np.maximum(seen, hidden).astype(np.float32)


def trust_aslant(trust: np.ndarray, agree: np.ndarray, cosine: np.ndarray, rule: TrustRule) -> np.ndarray:
    """Return the trust in a depth map's votes, (H, W) float32, above 1 where it holds though the surface turns away.

    Not in the paper. A vote counts by how squarely a view faces the surface, so that of the views of a smooth face the
    squarest decides nearly alone, and its error stays. Where many views agree it is the mean of them that is right, but
    for those that see the surface graze by: their depth is too far.

    Parameters
    ----------
    trust : (H, W) float32
        In the surface (`trust_depth`).
    agree : (H, W) uint8
        Views that have a surface where the pixel has it (`Agreement`).
    cosine : (H, W) float64
        Between the surface's normal and the ray to it, by which votes are multiplied (`facing_cosine`).
    rule : TrustRule
    """
    agreed = rise(agree.astype(np.float64), rule.aslant_agree_from, rule.aslant_agree_full)
    square = rise(cosine, rule.aslant_from, rule.aslant_full)
    return np.maximum(trust, agreed * square / np.maximum(cosine, 1e-3)).astype(np.float32)


def trust_free(
    trust: np.ndarray, too_far: np.ndarray, matched: np.ndarray, keyframes: int, sureness: float, rule: TrustRule
) -> np.ndarray:
    """Return the trust that the space before a depth map's surface is free, (H, W) float32, no less than `trust`.

    Not in the paper. Between spines and in hollows hardly two views have the same depth, mostly as it is too near; but
    the space before it is free all the same, unless others have a surface there. That none has says little where few
    photographs match around, and of a bare object. Where nearly all match, a part stands before it only in some views:
    then more of them may have one.

    Parameters
    ----------
    trust : (H, W) float32
        In the surface, as its votes count (`trust_aslant`).
    too_far : (H, W) uint8
        Views that have a surface before it (`Agreement`).
    matched : (H, W) float32
        Share of matches around (`share_matched`).
    keyframes : int
        That have depth.
    sureness : float
        Of the object's depth, in [0, 1] (`rate_sureness`).
    rule : TrustRule
    """
    times = 1 + (rule.free_textured - 1) * rise(matched, rule.textured_from, rule.textured_full)
    free = (too_far < times * rule.free_contradicted * keyframes) * rise(matched, rule.free_from, rule.free_full)
    return np.maximum(trust, rise(sureness, _BARE, _SURE) * free).astype(np.float32)


def rate_sureness(trust: Iterable[np.ndarray], masks: Iterable[np.ndarray], rule: TrustRule) -> float:
    """Return how sure an object's depth is as a whole, in [0, 1], by the mean trust in it.

    Not in the paper. On a bare or glossy thing most of the depth is not confirmed, and what seems to be is wrong more
    often than on a textured one: reflections agree, too. So what depth is worth in one place depends on the others.

    Parameters
    ----------
    trust, masks : iterable of (H, W) float32, of (H, W) bool
        Of each keyframe, as of a bare object (`trust_depth`), and where it shows the object; one mask at least is not
        empty.
    rule : TrustRule
    """
    means = [own[mask].mean(dtype=np.float64) for own, mask in zip(trust, masks, strict=True) if mask.any()]
    return float(rise(np.mean(means), rule.sure_from, rule.sure_full))


def rate_roundness(agreed: int, deep: int, sureness: float, rule: TrustRule) -> float:
    """Return how far an object may be taken to have no hollows but those that its masks show, in [0, 1].

    Not in the paper. On a bare or glossy thing depth lies in front of the surface and behind it. Where there is a
    hollow, some of the views that look into it have the same depth there; behind the smooth face of a helmet or a vase
    hardly any have. An object whose depth is sure shows its own hollows. Where no depth lies that deep, none tells of
    a hollow. Mirror images of the support plane count as any depth.

    Parameters
    ----------
    agreed, deep : int
        Pixels of all keyframes whose depth lies well inside the hull of the masks, those that `hollow_agree` views
        agree on and all.
    sureness : float
        Of the object's depth, in [0, 1] (`rate_sureness`).
    rule : TrustRule
    """
    return float((1 - sureness) * (1 - rise(agreed / max(deep, 1), rule.round_full, rule.round_until)))
