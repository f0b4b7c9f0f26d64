"""Expansion moves by graph cuts: every node keeps its label or takes one given label, whichever is best in all."""

from __future__ import annotations

import numpy as np
from maxflow import GraphFloat

from threedfs.segment.energy import LabelGraph


def expand(graph: LabelGraph, labels: np.ndarray, target: int) -> np.ndarray:
    """Return the labels of least energy that are reached by giving `target` to any set of nodes.

    Nodes that are given, that have the label already, or that may not have it, stay out of the cut: what they cost
    their neighbours is added to these neighbours' own costs ("folded").

    Parameters
    ----------
    graph : LabelGraph
    labels : (N,) uint8
    target : int

    Returns
    -------
    (N,) uint8
        A new array.
    """
    free = graph.is_open & (labels != target) & np.isfinite(graph.unary[:, target])
    nodes = np.flatnonzero(free)
    if len(nodes) == 0:
        return labels.copy()
    rank = np.full(len(labels), -1, np.int32)
    rank[nodes] = np.arange(len(nodes))
    keep = graph.unary[nodes, labels[nodes]].astype(np.float64)
    take = graph.unary[nodes, target].astype(np.float64)
    one, other = graph.pairs[:, 0], graph.pairs[:, 1]
    for ours, theirs in ((one, other), (other, one)):
        lone = free[ours] & ~free[theirs]
        where, weight, given = rank[ours[lone]], graph.weight[lone], labels[theirs[lone]]
        keep += np.bincount(where, weight * (labels[ours[lone]] != given), len(nodes))
        take += np.bincount(where, weight * (given != target), len(nodes))
    both = free[one] & free[other]
    i, j, weight = rank[one[both]], rank[other[both]], graph.weight[both].astype(np.float64)
    half = np.where(labels[one[both]] != labels[other[both]], weight / 2, 0)
    # cost when both keep: half of it on each, which the edge between them gives back when only one does
    keep += np.bincount(i, half, len(nodes)) + np.bincount(j, half, len(nodes))
    cut = GraphFloat(len(nodes), len(i))
    ids = cut.add_grid_nodes(len(nodes))
    cut.add_edges(i, j, weight - half, weight - half)
    least = np.minimum(keep, take)
    cut.add_grid_tedges(ids, take - least, keep - least)
    cut.maxflow()
    moved = labels.copy()
    moved[nodes[cut.get_grid_segments(ids)]] = target
    return moved
