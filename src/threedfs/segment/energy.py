"""The energy of a labelling of superpixels and voxels (Section 3.4, Eq. 19)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

BACKGROUND, OBJECT, EMPTY = 0, 1, 2


@dataclass(frozen=True)
class LabelGraph:
    """Nodes with costs for their labels, and pairs of nodes that had better agree (Potts).

    Attributes
    ----------
    unary : (N, L) float32
        Cost of each label at each node; infinite where a label is not allowed.
    pairs : (P, 2) int32
        Each pair once.
    weight : (P,) float32
        Cost of different labels at the two.
    is_open : (N,) bool
        Nodes whose labels are sought; those of the others are given.
    """

    unary: np.ndarray
    pairs: np.ndarray
    weight: np.ndarray
    is_open: np.ndarray


def energy(graph: LabelGraph, labels: np.ndarray) -> float:
    """Evaluate Eq. 19 for labels (N,), from the labels alone.

    Unary costs of nodes that are not open are left out: they are the same for all labellings.
    """
    nodes = np.flatnonzero(graph.is_open)
    single = graph.unary[nodes, labels[nodes]].sum(dtype=np.float64)
    apart = labels[graph.pairs[:, 0]] != labels[graph.pairs[:, 1]]
    return float(single + graph.weight[apart].sum(dtype=np.float64))
