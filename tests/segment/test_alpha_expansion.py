"""Oracle: expansion moves against brute force, against the library's own on a grid; given nodes, folded and not."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from maxflow import fastmin

from threedfs.segment.alpha_expansion import expand
from threedfs.segment.energy import LabelGraph, energy, fold_given


def random_graph(rng: np.random.Generator, nodes: int, labels: int, scale: float = 2.0) -> LabelGraph:
    """Make a graph with costs of random sign, of about a size, and weights of random size."""
    pairs = np.array([pair for pair in itertools.combinations(range(nodes), 2) if rng.random() < 0.5], np.int32)
    pairs = pairs.reshape(-1, 2)
    unary = rng.normal(0, scale, (nodes, labels)).astype(np.float32)
    return LabelGraph(unary, pairs, rng.random(len(pairs)).astype(np.float32) * 2)


def best_expansion(graph: LabelGraph, labels: np.ndarray, target: int) -> float:
    """Return the least energy over all sets of nodes that may take the target."""
    free = np.flatnonzero(np.isfinite(graph.unary[:, target]))
    energies = []
    for choice in itertools.product((False, True), repeat=len(free)):
        moved = labels.copy()
        moved[free[list(choice)]] = target
        energies.append(energy(graph, moved))
    return min(energies)


@pytest.mark.parametrize("seed", range(60))
def test_a_move_is_the_best_of_all_moves(seed):
    """From costs that pairs overrule to costs that settle most nodes without a cut."""
    rng = np.random.default_rng(seed)
    nodes = int(rng.integers(2, 11))
    graph = random_graph(rng, nodes, 3, scale=(0.5, 2.0, 8.0)[seed % 3])
    graph.unary[rng.random(nodes) < 0.2 * (seed % 2), 2] = np.inf
    labels = np.where(np.isinf(graph.unary[:, 2]), rng.integers(0, 2, nodes), rng.integers(0, 3, nodes)).astype(
        np.uint8
    )
    target = int(rng.integers(3))
    moved = expand(graph, labels, target)
    assert energy(graph, moved) == pytest.approx(best_expansion(graph, labels, target), abs=1e-4)
    assert np.all((moved == labels) | (moved == target))


@pytest.mark.parametrize("seed", range(20))
def test_with_two_labels_two_moves_reach_the_optimum(seed):
    rng = np.random.default_rng(seed)
    nodes = int(rng.integers(2, 11))
    graph = random_graph(rng, nodes, 2)
    found = expand(graph, expand(graph, np.zeros(nodes, np.uint8), 1), 0)
    every = [energy(graph, np.array(labels)) for labels in itertools.product((0, 1), repeat=nodes)]
    assert energy(graph, found) == pytest.approx(min(every), abs=1e-4)


@pytest.mark.parametrize("seed", range(20))
def test_moves_never_end_above_their_start(seed):
    rng = np.random.default_rng(seed)
    graph = random_graph(rng, 60, 3)
    labels = rng.integers(0, 3, 60).astype(np.uint8)
    before = energy(graph, labels)
    for target in (0, 1, 2, 0, 1, 2):
        labels = expand(graph, labels, target)
        assert energy(graph, labels) <= before + 1e-4
        before = energy(graph, labels)


def test_a_forbidden_label_is_never_taken():
    rng = np.random.default_rng(0)
    graph = random_graph(rng, 40, 3)
    graph.unary[:20, 2] = np.inf
    assert not (expand(graph, np.zeros(40, np.uint8), 2)[:20] == 2).any()


def test_grid_equals_the_library():
    rng = np.random.default_rng(1)
    unary = rng.random((12, 15, 3))
    number = np.arange(180, dtype=np.int32).reshape(12, 15)
    pairs = np.concatenate(
        [
            np.stack([number[:, :-1].ravel(), number[:, 1:].ravel()], axis=1),
            np.stack([number[:-1].ravel(), number[1:].ravel()], axis=1),
        ]
    )
    graph = LabelGraph(unary.reshape(-1, 3).astype(np.float32), pairs, np.full(len(pairs), 0.4, np.float32))
    theirs = fastmin.aexpansion_grid(unary, 0.4 * (1 - np.eye(3)), labels=np.zeros((12, 15), np.int_))
    ours = np.zeros(180, np.uint8)
    for _ in range(10):
        for target in range(3):
            ours = expand(graph, ours, target)
    assert energy(graph, ours) == pytest.approx(energy(graph, theirs.ravel().astype(np.uint8)), abs=1e-3)


@pytest.mark.parametrize("seed", range(10))
def test_folding_given_nodes_changes_nothing(seed):
    rng = np.random.default_rng(seed)
    whole, is_open = random_graph(rng, 40, 3), rng.random(40) < 0.5
    labels = rng.integers(0, 3, 40).astype(np.uint8)
    folded = fold_given(whole.pairs, whole.weight, labels, is_open, 3).with_costs(whole.unary[is_open])
    held = whole.unary.copy()
    held[~is_open] = 1e6
    held[~is_open, labels[~is_open]] = 0
    whole = LabelGraph(held, whole.pairs, whole.weight)
    for target in range(3):
        moved = labels.copy()
        moved[is_open] = expand(folded, labels[is_open], target)
        assert np.array_equal(moved, expand(whole, labels, target))
        change = energy(folded, moved[is_open]) - energy(folded, labels[is_open])
        assert change == pytest.approx(energy(whole, moved) - energy(whole, labels), abs=1e-3)
