"""Exact, oracle and property: matting components of images made of a few soft pieces."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import sparse
from scipy.ndimage import gaussian_filter

from threedfs.matting.assign import assign_components
from threedfs.matting.components import (
    ComponentRule,
    cluster_pixels,
    find_components,
    smallest_eigenvectors,
    sparsify,
)
from threedfs.matting.laplacian import matting_laplacian
from threedfs.matting.trimap import Trimap

COLORS = np.array([[200, 60, 40], [60, 90, 200], [70, 180, 80], [220, 200, 90]])
RULE = ComponentRule(eigenvectors=8, components=4, sparsity=0.9, iterations=10)


@pytest.fixture(scope="module")
def pieces():
    """An image of four soft pieces with a little noise, and their shares (H, W, 4)."""
    row, column = np.indices((40, 50))
    hard = np.stack([(row < 20) & (column < 25), (row < 20) & (column >= 25), (row >= 20) & (column < 25)], axis=-1)
    shares = gaussian_filter(np.dstack([hard, ~hard.any(axis=-1)]).astype(float), (1, 1, 0))
    noise = np.random.default_rng(0).normal(0, 2, (40, 50, 3))
    return np.clip(shares @ COLORS + noise, 0, 255).astype(np.uint8), shares


@pytest.fixture(scope="module")
def laplacian(pieces):
    return matting_laplacian(pieces[0], 1e-4)


def test_eigenvectors_are_those_of_a_dense_solver():
    """Oracle."""
    image = np.random.default_rng(3).integers(0, 255, (14, 13, 3)).astype(np.uint8)
    matrix = matting_laplacian(image, 1e-3)
    values, vectors = smallest_eigenvectors(matrix, 6, np.random.default_rng(0))
    np.testing.assert_allclose(values, np.linalg.eigvalsh(matrix.toarray())[:6], atol=1e-9)
    np.testing.assert_allclose(matrix @ vectors, vectors * values, atol=1e-8)
    np.testing.assert_allclose(vectors.T @ vectors, np.eye(6), atol=1e-9)


def test_pieces_are_found_and_sum_to_one(pieces, laplacian):
    found = find_components(laplacian, RULE, np.random.default_rng(0))
    np.testing.assert_allclose(found.sum(axis=1), 1, atol=1e-6)
    true = pieces[1].reshape(-1, 4)
    match = [int(np.abs(found - true[:, [k]]).mean(axis=0).argmin()) for k in range(4)]
    assert sorted(match) == [0, 1, 2, 3]
    assert np.abs(found[:, match] - true).mean() < 0.03


def test_newton_makes_components_sparser(laplacian):
    rng = np.random.default_rng(0)
    values, vectors = smallest_eigenvectors(laplacian, 8, rng)
    start = cluster_pixels(values, vectors, 4, rng)
    assert (start.sum(axis=1) == 1).all() and start.any(axis=0).all()

    def prior(found):
        return (np.abs(found) ** 0.9 + np.abs(1 - found) ** 0.9).sum()

    costs = [prior(sparsify(vectors, start, 0.9, steps)) for steps in (0, 1, 5, 20)]
    assert costs[3] <= costs[2] <= costs[1] <= costs[0] and costs[3] < 0.999 * costs[0]
    np.testing.assert_allclose(sparsify(vectors, start, 0.9, 0), vectors @ (vectors.T @ start), atol=1e-12)


def test_same_seed_same_bytes(laplacian):
    first, second = (find_components(laplacian, RULE, np.random.default_rng(5)) for _ in range(2))
    assert first.tobytes() == second.tobytes()


def test_of_all_sets_the_one_that_the_trimap_asks_for_is_taken():
    """Exact: hard components whose pixels the trimap knows; in any order of them."""
    owner = np.repeat(np.arange(6), 4).reshape(6, 4)
    components = (owner.reshape(-1)[:, None] == np.arange(6)).astype(float)
    nothing = sparse.csr_array((24, 24))
    wanted = np.array([True, False, True, True, False, False])
    inner = wanted[owner] & (np.indices((6, 4))[1] < 1)
    trimap = Trimap(inner, inner | (np.indices((6, 4))[1] < 3))
    assert assign_components(components, nothing, trimap).tolist() == wanted.tolist()
    order = np.array([3, 5, 0, 1, 4, 2])
    assert assign_components(components[:, order], nothing, trimap).tolist() == wanted[order].tolist()


def test_where_the_trimap_knows_nothing_the_image_decides():
    """Exact: an unknown component goes with the one that it has no outline against."""
    image = np.zeros((6, 9, 3), np.uint8)
    image[:, 6:] = 255
    owner = np.tile(np.repeat([0, 1, 2], 3), (6, 1))
    components = (owner.reshape(-1)[:, None] == np.arange(3)).astype(float)
    laplacian = matting_laplacian(image, 1e-6)
    for inner in (owner == 0, owner == 2):
        trimap = Trimap(inner, inner | (owner == 1))
        assert assign_components(components, laplacian, trimap).tolist() == [inner[0, 0], inner[0, 0], inner[0, 8]]
