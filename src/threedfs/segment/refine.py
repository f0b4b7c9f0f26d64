"""Masks to the pixel: the band of a keyframe labelled once more, pixel by pixel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from threedfs.segment.alpha_expansion import expand
from threedfs.segment.color_model import ColorModel, TableMatch, lab_image, truncate
from threedfs.segment.energy import BACKGROUND, OBJECT, fold_given
from threedfs.segment.evidence import ImageEvidence
from threedfs.segment.unaries import silhouette_unary, soften_silhouette

_STEPS = ((0, 1), (1, 0), (1, 1), (1, -1))


@dataclass(frozen=True)
class RefineRule:
    """Weights of the pixels' energy; `SegmentParams` says more of each value."""

    color_cap: float
    color_weight: float
    label_weight: float
    silhouette_weight: float
    pair_weight: float
    contrast: float


def refine_mask(
    evidence: ImageEvidence, labels: np.ndarray, colors: ColorModel, silhouette: np.ndarray | None, rule: RefineRule
) -> np.ndarray:
    """Return the object's mask (H, W) bool by a cut over the pixels of the band.

    Not in the paper, whose masks are unions of superpixels. A pixel pays for its colour (Eqs. 20, 21, of the pixel
    alone), for leaving the label of its superpixel and the voxels' soft silhouette, and for differing from its 8
    neighbours where contrast is low.

    Parameters
    ----------
    evidence : ImageEvidence
    labels : (count,) uint8
        Of the superpixels.
    colors : ColorModel
    silhouette : (H, W) bool or None
        Of the object's voxels, if there are any.
    rule : RefineRule
    """
    start = evidence.superpixels.paint(labels == OBJECT)
    inside = np.append(evidence.is_open, False)[evidence.superpixels.index]
    _, lab, table = evidence.band
    unary = color_unary(colors, lab, table, rule)
    own = start[inside].astype(np.uint8)
    unary[np.arange(len(own)), 1 - own] += rule.label_weight
    if silhouette is not None:
        share = soften_silhouette(silhouette, evidence.silhouette_reach)[inside]
        unary += rule.silhouette_weight * silhouette_unary(share)
    pairs, weight = weigh_neighbours(lab_image(evidence.image), inside, rule)
    graph = fold_given(pairs, weight, start.reshape(-1).astype(np.uint8), inside.reshape(-1), 2).with_costs(unary)
    mask = start.copy()
    mask[inside] = expand(graph, expand(graph, own, OBJECT), BACKGROUND) == OBJECT
    return mask


def color_unary(colors: ColorModel, lab: np.ndarray, table: TableMatch | None, rule: RefineRule) -> np.ndarray:
    """Return what background and object cost pixels of Lab colours (N, 3) by these alone, (N, 2) (Eqs. 20, 21)."""
    chance = colors.posterior(lab, table)
    return rule.color_weight * np.stack([truncate(p, rule.color_cap) for p in (1 - chance, chance)], axis=1)


def weigh_neighbours(lab: np.ndarray, inside: np.ndarray, rule: RefineRule) -> tuple[np.ndarray, np.ndarray]:
    """Return pairs (P, 2) int32 of 8-neighbours, one of them in the band at least, and the cost of parting them (P,).

    Parameters
    ----------
    lab : (H, W, 3) float32
    inside : (H, W) bool
        The band.
    rule : RefineRule
    """
    rows, columns = inside.shape
    number = np.arange(inside.size, dtype=np.int32).reshape(inside.shape)
    pairs, weights = [], []
    for down, across in _STEPS:
        ours = np.s_[: rows - down, max(0, -across) : columns - max(0, across)]
        theirs = np.s_[down:, max(0, across) : columns - max(0, -across)]
        either = inside[ours] | inside[theirs]
        apart = ((lab[ours][either] - lab[theirs][either]) ** 2).sum(-1)
        pairs.append(np.stack([number[ours][either], number[theirs][either]], axis=1))
        weights.append(np.exp(-apart / (2 * rule.contrast**2)) / np.hypot(down, across))
    return np.concatenate(pairs), (rule.pair_weight * np.concatenate(weights)).astype(np.float32)
