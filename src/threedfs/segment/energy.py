"""The energy of a labelling of superpixels and voxels (Section 3.4, Eq. 19)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

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
    """

    unary: np.ndarray
    pairs: np.ndarray
    weight: np.ndarray

    def with_costs(self, unary: np.ndarray) -> LabelGraph:
        """Return the graph with costs (N, L) added to those of its labels."""
        return LabelGraph((self.unary + unary).astype(np.float32), self.pairs, self.weight)


def energy(graph: LabelGraph, labels: np.ndarray) -> float:
    """Evaluate Eq. 19 for labels (N,), from the labels alone."""
    single = graph.unary[np.arange(len(labels)), labels].sum(dtype=np.float64)
    apart = labels[graph.pairs[:, 0]] != labels[graph.pairs[:, 1]]
    return float(single + graph.weight[apart].sum(dtype=np.float64))


def fold_given(
    pairs: np.ndarray, weight: np.ndarray, labels: np.ndarray, is_open: np.ndarray, kinds: int
) -> LabelGraph:
    """Return the graph of the nodes that are open, in their order; the labels of all others are given.

    What a pair with a given node costs becomes a cost of the open one's labels; pairs of given nodes are left out, as
    they cost the same whatever the open ones are.

    Parameters
    ----------
    pairs : (P, 2) int32
        Of all nodes.
    weight : (P,) float32
    labels : (N,) uint8
        Read where a node is not open.
    is_open : (N,) bool
    kinds : int
        Number of labels.
    """
    rank = np.cumsum(is_open, dtype=np.int32) - 1
    rank[~is_open] = -1
    return LabelGraph(*_fold(pairs, weight, labels, rank, int(is_open.sum()), kinds))


@njit(cache=True)
def _fold(pairs, weight, labels, rank, count, kinds):
    unary = np.zeros((count, kinds), np.float32)
    kept = 0
    for p in range(len(pairs)):
        kept += rank[pairs[p, 0]] >= 0 and rank[pairs[p, 1]] >= 0
    between, cost = np.empty((kept, 2), np.int32), np.empty(kept, np.float32)
    kept = 0
    for p in range(len(pairs)):
        one, other = pairs[p]
        if rank[one] >= 0 and rank[other] >= 0:
            between[kept, 0], between[kept, 1], cost[kept] = rank[one], rank[other], weight[p]
            kept += 1
        elif rank[one] >= 0 or rank[other] >= 0:
            ours, given = (rank[one], labels[other]) if rank[one] >= 0 else (rank[other], labels[one])
            for label in range(kinds):
                if label != given:
                    unary[ours, label] += weight[p]
    return unary, between, cost
