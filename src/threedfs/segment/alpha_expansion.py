"""Expansion moves by graph cuts: every node keeps its label or takes one given label, whichever is best in all."""

from __future__ import annotations

import numpy as np
from maxflow import GraphFloat
from numba import njit

from threedfs.segment.energy import LabelGraph

_OPEN, _KEEPS, _TAKES = 0, 1, 2
_WORTH = 0.002
"""Share of the open nodes that a further pass must settle to be worth its time."""


def expand(graph: LabelGraph, labels: np.ndarray, target: int) -> np.ndarray:
    """Return the labels of least energy that are reached by giving `target` to any set of nodes.

    Only what is in question reaches the cut. Nodes that have the label already, or may not have it, are folded into
    their neighbours' costs, and so is each node whose own costs differ by more than all its pairs together could make
    up for: whatever its neighbours do, its choice is the same.

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
    nodes = np.flatnonzero((labels != target) & np.isfinite(graph.unary[:, target]))
    rank = np.full(len(labels), -1, np.int32)
    rank[nodes] = np.arange(len(nodes))
    keep = graph.unary[nodes, labels[nodes]].astype(np.float64)
    take = graph.unary[nodes, target].astype(np.float64)
    one, other, between = _connect(graph.pairs, graph.weight, labels, rank, target, keep, take)
    choice, count = _settle(one, other, between, keep, take)
    takes = choice == _TAKES
    left = np.flatnonzero(choice == _OPEN)
    if len(left):
        rank[left] = np.arange(len(left))
        takes[left] = _cut(
            rank[one[:count]], rank[other[:count]], between[:count].astype(np.float64), keep[left], take[left]
        )
    moved = labels.copy()
    moved[nodes[takes]] = target
    return moved


def _cut(one, other, between, keep, take):
    """Say which nodes take the label, (N,) bool, in the least cut."""
    cut = GraphFloat(len(keep), len(one))
    ids = cut.add_grid_nodes(len(keep))
    cut.add_edges(one, other, between, between)
    least = np.minimum(keep, take)
    cut.add_grid_tedges(ids, take - least, keep - least)
    cut.maxflow()
    return cut.get_grid_segments(ids)


@njit(cache=True)
def _connect(pairs, weight, labels, rank, target, keep, take):
    """Return the edges between nodes with a choice, by rank: ends and the cost when one keeps and the other takes.

    Costs of pairs with others are added to `keep` and `take`.
    """
    count = 0
    for p in range(len(pairs)):
        count += rank[pairs[p, 0]] >= 0 and rank[pairs[p, 1]] >= 0
    one, other, between = np.empty(count, np.int32), np.empty(count, np.int32), np.empty(count, np.float32)
    count = 0
    for p in range(len(pairs)):
        a, b = pairs[p]
        if rank[a] >= 0 and rank[b] >= 0:
            # cost when both keep: half of it on each, which the edge between them gives back when only one does
            half = weight[p] / 2 if labels[a] != labels[b] else 0.0
            keep[rank[a]] += half
            keep[rank[b]] += half
            one[count], other[count], between[count] = rank[a], rank[b], weight[p] - half
            count += 1
        elif rank[a] >= 0 or rank[b] >= 0:
            ours, given = (a, labels[b]) if rank[a] >= 0 else (b, labels[a])
            if given != labels[ours]:
                keep[rank[ours]] += weight[p]
            if given != target:
                take[rank[ours]] += weight[p]
    return one, other, between


@njit(cache=True)
def _settle(one, other, between, keep, take):
    """Settle what needs no cut; return the choice of each node, and how many edges are left, which come first."""
    choice = np.zeros(len(keep), np.uint8)
    edges, is_open = len(one), len(keep)
    while is_open:
        reach = np.zeros(len(keep))
        for e in range(edges):
            reach[one[e]] += between[e]
            reach[other[e]] += between[e]
        settled = 0
        for n in range(len(keep)):
            if choice[n] == _OPEN and abs(take[n] - keep[n]) > reach[n]:
                choice[n] = _KEEPS if take[n] > keep[n] else _TAKES
                settled += 1
        left = 0
        for e in range(edges):
            a, b = one[e], other[e]
            if choice[a] == _OPEN and choice[b] == _OPEN:
                one[left], other[left], between[left] = a, b, between[e]
                left += 1
            elif choice[a] == _OPEN or choice[b] == _OPEN:
                ours, theirs = (a, choice[b]) if choice[a] == _OPEN else (b, choice[a])
                if theirs == _TAKES:
                    keep[ours] += between[e]
                else:
                    take[ours] += between[e]
        edges, is_open = left, is_open - settled
        if settled <= _WORTH * is_open:
            break
    return choice, edges
