"""Matting components: soft pieces of an image that sum to one (Levin, Rav-Acha, Lischinski 2008)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.cluster.vq import kmeans2
from scipy.sparse.linalg import LinearOperator, eigsh

from threedfs.matting.laplacian import factorise

_SHIFT = 1e-8
"""What is added to the Laplacian's diagonal, so that it can be solved with; its smallest eigenvalue is zero."""
_ROUNDS = 30
"""Of k-means."""
_FLOOR = 1e-3
"""Distance from 0 and 1 below which a value weighs no more: the prior's slope is infinite there."""


@dataclass(frozen=True)
class ComponentRule:
    """How components are found; `SpectralMattingParams` says more of each value."""

    eigenvectors: int
    components: int
    sparsity: float
    iterations: int


def find_components(laplacian: sparse.csr_array, rule: ComponentRule, rng: np.random.Generator) -> np.ndarray:
    """Return the matting components of an image, in whose null space true opacities lie but for little.

    Parameters
    ----------
    laplacian : (N, N) float64
        `matting_laplacian`.
    rule : ComponentRule
    rng : numpy.random.Generator
        Draws the start of the eigenvectors and of the clusters.

    Returns
    -------
    (N, K) float64
        Rows sum to one. As many as `rule.components`, or fewer if clusters are empty.
    """
    values, vectors = smallest_eigenvectors(laplacian, rule.eigenvectors, rng)
    start = cluster_pixels(values, vectors, rule.components, rng)
    return sparsify(vectors, start, rule.sparsity, rule.iterations)


def smallest_eigenvectors(
    laplacian: sparse.csr_array, count: int, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Return the smallest eigenvalues (count,) of a Laplacian, rising, and their vectors (N, count) of unit length.

    By Lanczos iterations on the inverse of the Laplacian, from a factorisation of it.
    """
    size = laplacian.shape[0]
    factors = factorise(laplacian + _SHIFT * sparse.eye_array(size))
    inverse = LinearOperator((size, size), matvec=factors.solve, dtype=np.float64)
    start = rng.standard_normal(size)
    values, vectors = eigsh(laplacian, min(count, size - 1), sigma=-_SHIFT, OPinv=inverse, v0=start)
    order = np.argsort(values, kind="stable")
    return np.maximum(values[order], 0), vectors[:, order]


def cluster_pixels(values: np.ndarray, vectors: np.ndarray, count: int, rng: np.random.Generator) -> np.ndarray:
    """Return hard clusters (N, K) bool of pixels by their places in the eigenvectors, each with a pixel at least.

    A vector counts by one over the root of its eigenvalue (Section 4 of the source): smoother ones tell more. The
    constant vector tells nothing, and is left out.

    Parameters
    ----------
    values : (M,) float64
    vectors : (N, M) float64
    count : int
        Largest K.
    rng : numpy.random.Generator
    """
    places = vectors[:, 1:] / np.sqrt(np.maximum(values[1:], _SHIFT))
    _, owner = kmeans2(places, count, iter=_ROUNDS, minit="++", rng=rng, missing="warn")
    found = np.unique(owner)
    return owner[:, None] == found[None, :]


def sparsify(vectors: np.ndarray, start: np.ndarray, sparsity: float, iterations: int) -> np.ndarray:
    """Return the components (N, K) in the span of eigenvectors whose values are as near to 0 or 1 as can be.

    Newton's method on the sum of |a|^s + |1 - a|^s over pixels and components, under the condition that components sum
    to one in every pixel (Eqs. 8 to 10 of the source). Each step solves for the weights of all components but the
    last, which the condition gives. The lowest sum of all steps is kept: near 0 and 1 the sum is not smooth.

    Parameters
    ----------
    vectors : (N, M) float64
        With the constant in their span.
    start : (N, K) bool
        Clusters, projected onto the span first.
    sparsity : float
        s, in (0, 1].
    iterations : int
        Steps; with 0, the projected clusters.
    """
    weights = vectors.T @ start
    components = vectors @ weights
    ones = vectors.T @ np.ones(len(vectors))
    best, least = components, _prior(components, sparsity)
    for _ in range(iterations if start.shape[1] > 1 else 0):
        weights = _newton_step(vectors, components, ones, sparsity)
        components = vectors @ weights
        cost = _prior(components, sparsity)
        if cost < least:
            best, least = components, cost
    return best


def _prior(components: np.ndarray, sparsity: float) -> float:
    return float((np.abs(components) ** sparsity + np.abs(1 - components) ** sparsity).sum())


def _newton_step(vectors: np.ndarray, components: np.ndarray, ones: np.ndarray, sparsity: float) -> np.ndarray:
    """Return weights (M, K) that minimise the sum of u a^2 + v (1 - a)^2, u and v by the components so far."""
    size, count = vectors.shape[1], components.shape[1]
    near_zero, near_one = (np.maximum(np.abs(part), _FLOOR) ** (sparsity - 2) for part in (components, 1 - components))
    curved = [(vectors * (near_zero[:, k] + near_one[:, k])[:, None]).T @ vectors for k in range(count)]
    pulled = [vectors.T @ near_one[:, k] for k in range(count)]
    # the last component is the constant less all others: its cost counts in the rows of each of them
    free = count - 1
    matrix = np.tile(curved[-1], (free, free))
    for k in range(free):
        block = slice(k * size, (k + 1) * size)
        matrix[block, block] += curved[k]
    right = np.concatenate([pulled[k] - pulled[-1] + curved[-1] @ ones for k in range(free)])
    solved = np.linalg.solve(matrix, right).reshape(free, size).T
    return np.column_stack([solved, ones - solved.sum(axis=1)])
