"""Grow trees whose leaves hold label patches (Dollar and Zitnick 2013, Section 2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from threedfs.edges.forest import LABEL, Forest
from threedfs.edges.training.samples import Samples


@dataclass(frozen=True)
class Growth:
    """When a tree ends.

    Attributes
    ----------
    least_samples : int
        Of each child of a split.
    depth : int
        Of the tree at most.
    pairs : int
        Pairs of pixels by which the labels of a node are compared.
    """

    least_samples: int = 8
    depth: int = 64
    pairs: int = 256


def grow_tree(samples: Samples, growth: Growth, rng: np.random.Generator) -> Forest:
    """Grow one tree, a forest of its own.

    At each node a label becomes a vector that tells of random pairs of pixels whether they lie in one segment; the
    sign of its first principal component is its class. The feature and threshold that leave the least Gini impurity
    of the classes split the node. A leaf holds the label whose vector is nearest to the mean of its samples'.
    """
    feature, threshold, child, labels = [], [], [], []
    pending = [(np.arange(len(samples.labels)), 0)]
    flat = samples.labels.reshape(len(samples.labels), -1)
    feature.append(-1), threshold.append(0.0), child.append(0)
    nodes = [0]
    while pending:
        rows, depth = pending.pop()
        node = nodes.pop()
        same = _compare_pairs(flat, rows, rng, growth.pairs)
        split = None
        if len(rows) >= 2 * growth.least_samples and depth < growth.depth:
            classes = _divide(same)
            if classes is not None:
                split = _find_split(samples.bins, rows, classes, growth.least_samples)
        if split is None or split[0] < 0:
            child[node] = len(labels)
            labels.append(samples.labels[rows[_find_medoid(same)]])
            continue
        chosen, edge = split
        below = samples.bins[chosen, rows] <= edge
        feature[node] = int(samples.features[chosen])
        threshold[node] = samples.edges[chosen, edge]
        child[node] = len(feature)
        for side in (rows[below], rows[~below]):
            nodes.append(len(feature))
            feature.append(-1), threshold.append(0.0), child.append(0)
            pending.append((side, depth + 1))
    return Forest(
        np.zeros(1, np.int32),
        np.array(feature, np.int32),
        np.array(threshold, np.float32),
        np.array(child, np.int32),
        np.array(labels, np.uint8),
    )


def join_trees(trees: list[Forest]) -> Forest:
    """Make one forest of several."""
    nodes = np.cumsum([0, *(len(tree.feature) for tree in trees)])
    leaves = np.cumsum([0, *(len(tree.labels) for tree in trees)])
    child = [
        tree.child + np.where(tree.feature < 0, leaf, node).astype(np.int32)
        for tree, node, leaf in zip(trees, nodes, leaves, strict=False)
    ]
    return Forest(
        np.concatenate([tree.roots + node for tree, node in zip(trees, nodes, strict=False)]).astype(np.int32),
        np.concatenate([tree.feature for tree in trees]),
        np.concatenate([tree.threshold for tree in trees]),
        np.concatenate(child).astype(np.int32),
        np.concatenate([tree.labels for tree in trees]),
    )


def _compare_pairs(flat, rows, rng, pairs):
    """Return (N, P) float32: 1 where a random pair of pixels lies in different segments of a sample's label."""
    first = rng.integers(LABEL * LABEL, size=pairs)
    second = (first + rng.integers(1, LABEL * LABEL, size=pairs)) % (LABEL * LABEL)
    return _differ(flat, rows, first, second)


@njit(cache=True)
def _differ(flat, rows, first, second):
    differ = np.empty((len(rows), len(first)), np.float32)
    for n in range(len(rows)):
        for p in range(len(first)):
            differ[n, p] = flat[rows[n], first[p]] != flat[rows[n], second[p]]
    return differ


def _divide(differ):
    """Return classes (N,) bool by the sign of the first principal component; None if all labels are alike."""
    mean = differ.mean(axis=0, dtype=np.float64)
    if not np.any((mean > 0) & (mean < 1)):
        return None
    # Sums of ones are exact in any order, so a matrix product of many threads gives the same bytes.
    product = (differ.T @ differ).astype(np.float64)
    covariance = product / len(differ) - np.outer(mean, mean)
    return _project(differ, mean, _find_axis(covariance)) > 0


@njit(cache=True)
def _find_axis(covariance):
    """Return the eigenvector of the largest eigenvalue by power iteration, from the column of largest variance."""
    size = len(covariance)
    start = 0
    for k in range(size):
        if covariance[k, k] > covariance[start, start]:
            start = k
    axis = covariance[start].copy()
    for _ in range(30):
        following = np.zeros(size)
        square = 0.0
        for row in range(size):
            for column in range(size):
                following[row] += covariance[row, column] * axis[column]
            square += following[row] ** 2
        axis = following / np.sqrt(square)
    return axis


@njit(cache=True)
def _project(differ, mean, axis):
    result = np.zeros(len(differ))
    for n in range(len(differ)):
        for p in range(len(axis)):
            result[n] += (differ[n, p] - mean[p]) * axis[p]
    return result


@njit(cache=True)
def _find_medoid(differ):
    """Return the row nearest to the mean."""
    rows, columns = differ.shape
    mean = np.zeros(columns)
    for n in range(rows):
        for p in range(columns):
            mean[p] += differ[n, p]
    best, least = 0, np.inf
    for n in range(rows):
        distance = 0.0
        for p in range(columns):
            distance += (differ[n, p] - mean[p] / rows) ** 2
        if distance < least:
            best, least = n, distance
    return best


@njit(cache=True)
def _find_split(bins, rows, classes, least):
    """Return the feature and the last bin of its lower side that divide the classes best; -1 if none does."""
    total, positive = len(rows), 0
    for n in range(total):
        positive += classes[n]
    best_feature, best_bin = -1, 0
    # Least impurity is the largest sum of squared class counts over the size of each side.
    best = (positive**2 + (total - positive) ** 2) / total + 1e-9 * total
    counts = np.zeros((64, 2), np.int64)
    for feature in range(bins.shape[0]):
        counts[:] = 0
        row = bins[feature]
        for n in range(total):
            counts[row[rows[n]], int(classes[n])] += 1
        below, below_positive = 0, 0
        for k in range(63):
            if counts[k, 0] + counts[k, 1] == 0:
                continue
            below += counts[k, 0] + counts[k, 1]
            below_positive += counts[k, 1]
            above, above_positive = total - below, positive - below_positive
            if below < least or above < least:
                continue
            gain = (below_positive**2 + (below - below_positive) ** 2) / below
            gain += (above_positive**2 + (above - above_positive) ** 2) / above
            if gain > best:
                best, best_feature, best_bin = gain, feature, k
    return best_feature, best_bin
