"""Exact, property and oracle: priors, and the multigrid solve against a direct one."""

import itertools

import numpy as np
import pytest
import scipy.sparse as sparse
from scipy.sparse.linalg import spsolve

from threedfs.depth.bending import HALF_OFFSETS, PRIORS, assemble_prior
from threedfs.depth.galerkin import coarsen_diagonal, coarsen_prior, padded_shape
from threedfs.depth.linear_solve import pose_problem, solve_surface
from threedfs.depth.multigrid import Preconditioner

SHAPE = (50, 61)


def random_weight(seed=0, shape=SHAPE):
    rng = np.random.default_rng(seed)
    return np.exp(-5 * (rng.random(shape) > 0.95))


def sparse_matrix(stencil):
    height, width = stencil.shape[1:]
    index = np.arange(height * width).reshape(height, width)
    rows, columns, values = [], [], []
    for k, (dv, du) in enumerate(HALF_OFFSETS):
        v, u = np.nonzero(stencil[k])
        here, there, value = index[v, u], index[v + dv, u + du], stencil[k, v, u]
        rows += [here] if k == 0 else [here, there]
        columns += [there] if k == 0 else [there, here]
        values += [value] if k == 0 else [value, value]
    n = height * width
    return sparse.csc_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), (n, n))


def energy_by_stencil(depth, weight, prior):
    return depth.ravel() @ sparse_matrix(assemble_prior(weight, prior)) @ depth.ravel()


def energy_by_definition(depth, weight, prior):
    """Eq. 3, by differences of the whole array."""
    if prior == "first_order":
        along_u = np.minimum(weight[:, :-1], weight[:, 1:]) * np.diff(depth, axis=1) ** 2
        along_v = np.minimum(weight[:-1], weight[1:]) * np.diff(depth, axis=0) ** 2
        return along_u.sum() + along_v.sum()
    energy = (weight[:, 1:-1] * np.diff(depth, 2, axis=1) ** 2).sum()
    energy += (weight[1:-1] * np.diff(depth, 2, axis=0) ** 2).sum()
    if prior == "rotation_invariant":
        mixed = np.diff(np.diff(depth, axis=0), axis=1)
        cell = np.minimum(np.minimum(weight[:-1, :-1], weight[:-1, 1:]), np.minimum(weight[1:, :-1], weight[1:, 1:]))
        energy += (2 * cell * mixed**2).sum()
    return energy


@pytest.mark.parametrize("prior", PRIORS)
def test_stencil_is_the_energys_matrix(prior):
    depth, weight = np.random.default_rng(1).standard_normal(SHAPE), random_weight()
    expected = energy_by_definition(depth, weight, prior)
    assert energy_by_stencil(depth, weight, prior) == pytest.approx(expected, rel=1e-12)


def test_planes_do_not_bend():
    v, u = np.mgrid[: SHAPE[0], : SHAPE[1]]
    slanted = 0.3 * u - 0.2 * v + 4
    for prior in ("second_order", "rotation_invariant"):
        assert abs(energy_by_stencil(slanted, random_weight(), prior)) < 1e-9
    assert energy_by_stencil(slanted, np.ones(SHAPE), "first_order") > 1
    assert abs(energy_by_stencil(np.full(SHAPE, 2.0), np.ones(SHAPE), "first_order")) < 1e-9


def test_only_the_rotation_invariant_prior_ignores_rotation():
    """A saddle u v is (u^2 - v^2) / 2 turned by 45 degrees: equal bending, but no second derivative along the axes."""
    v, u = np.mgrid[-20:21, -20:21].astype(float)
    straight, turned, weight = (u**2 - v**2) / 2, u * v, np.ones((41, 41))
    invariant = [energy_by_stencil(d, weight, "rotation_invariant") for d in (straight, turned)]
    # Second differences are taken at 39 x 41 places, mixed ones at 40 x 40: 0.1 % apart.
    assert invariant[0] == pytest.approx(invariant[1], rel=2e-3)
    assert abs(energy_by_stencil(turned, weight, "second_order")) < 1e-9
    assert energy_by_stencil(straight, weight, "second_order") > 1000


def test_padded_shapes_halve_evenly():
    assert padded_shape((480, 640)) == (481, 641)
    assert padded_shape((10, 12)) == (11, 13) or padded_shape((10, 12)) == (10, 12)


def bilinear_interpolation(shape):
    """The (fine, coarse) matrix of interpolation, from one axis each."""

    def along(fine):
        nodes = np.arange((fine + 1) // 2)
        return np.maximum(1 - np.abs(np.arange(fine)[:, None] / 2 - nodes), 0)

    return sparse.kron(sparse.csc_matrix(along(shape[0])), sparse.csc_matrix(along(shape[1])))


@pytest.mark.parametrize("prior", PRIORS)
def test_coarse_matrices_are_galerkin_products(prior):
    """Oracle: interpolation as a sparse matrix."""
    shape = (53, 65)
    levels = coarsen_prior(random_weight(5, shape), prior)
    assert [level.shape for level in levels] == [(53, 65), (27, 33), (14, 17)]
    matrix = sparse_matrix(assemble_prior(random_weight(5, shape), prior))
    for fine, coarse in itertools.pairwise(levels):
        interpolation = bilinear_interpolation(fine.shape)
        matrix = interpolation.T @ matrix @ interpolation
        planes = coarse.planes.reshape(13, coarse.shape[0] + 4, coarse.shape[1] + 4)
        assert abs(sparse_matrix(planes[:, 2:-2, 2:-2]) - matrix).max() < 1e-12
        assert not coarse.planes[sorted(set(range(13)) - set(coarse.used))].any()
        assert np.count_nonzero(planes) == np.count_nonzero(planes[:, 2:-2, 2:-2])


def test_preconditioner_is_symmetric_and_positive():
    """Single precision: relative 1e-4."""
    shape = padded_shape((60, 70))
    levels = coarsen_prior(random_weight(2, shape), "rotation_invariant")
    preconditioner = Preconditioner([levels, coarsen_diagonal(np.full(shape, 1e-3))], [1.0, 1.0])
    rng = np.random.default_rng(3)
    a, b = (np.pad(rng.standard_normal(shape), 2).ravel() for _ in range(2))
    left, right = a @ preconditioner.apply(b), b @ preconditioner.apply(a)
    assert left == pytest.approx(right, rel=1e-4, abs=1e-4 * abs(a @ preconditioner.apply(a)))
    assert a @ preconditioner.apply(a) > 0


@pytest.mark.parametrize("prior", PRIORS)
def test_two_grids_equal_the_textbook_cycle(prior):
    """Oracle: smoothing, a direct coarse solve and smoothing again, with sparse matrices; single precision."""
    shape = (33, 45)
    levels = coarsen_prior(random_weight(6, shape), prior)
    data = coarsen_diagonal(np.full(shape, 0.1))
    assert len(levels) == 2
    inner = np.s_[:, 2:-2, 2:-2]
    fine, coarse = (
        sparse_matrix((a.planes + b.planes).reshape(13, a.shape[0] + 4, a.shape[1] + 4)[inner])
        for a, b in zip(levels, data, strict=True)
    )
    interpolation = bilinear_interpolation(shape)
    inverse = 1 / fine.diagonal()
    radius = (inverse * np.abs(fine).sum(axis=1).A1).max()
    right = np.random.default_rng(7).standard_normal(shape).ravel()

    def smooth(solution):
        step = 0
        for k in range(2):
            residual = right - fine @ solution
            step = (2 * k - 1) / (2 * k + 3) * step * (k > 0) + (8 * k + 4) / (2 * k + 3) / radius * inverse * residual
            solution = solution + step
        return solution

    expected = smooth(np.zeros(len(right)))
    expected = expected + interpolation @ spsolve(coarse.tocsc(), interpolation.T @ (right - fine @ expected))
    expected = smooth(expected).reshape(shape)
    found = Preconditioner([levels, data], [1.0, 1.0]).apply(np.pad(right.reshape(shape), 2).ravel())
    found = found.reshape(shape[0] + 4, shape[1] + 4)[2:-2, 2:-2]
    assert np.abs(found - expected).max() < 1e-4 * np.abs(expected).max()


def weak_problem(prior):
    """Confident pixels are few, a large region has next to no data, measurements weigh a million times more."""
    rng = np.random.default_rng(4)
    confidence = np.where(rng.random(SHAPE) < 0.3, 1.0, 1e-4)
    confidence[15:40, 20:] = 1e-5
    measurement = np.where(rng.random(SHAPE) < 0.02, 1000.0, 0.0)
    v, u = np.mgrid[: SHAPE[0], : SHAPE[1]]
    truth = 1 + 0.2 * np.sin(u / 20) + 0.1 * np.cos(v / 15)
    auxiliary = truth + 0.03 * rng.standard_normal(SHAPE)
    weight = random_weight()
    return weight, confidence, measurement, truth, auxiliary, pose_problem(weight, confidence, measurement, prior)


@pytest.mark.parametrize("prior", PRIORS)
@pytest.mark.parametrize("coupling_factor, smoothness", [(0.5, 0.1), (10.0, 10.0), (1.0, 1e3)])
def test_solution_equals_a_direct_solve(prior, coupling_factor, smoothness):
    """Away from the padding, whose weight of 1e-4 bends the last rows, within 1 % of the noise of 0.03."""
    weight, confidence, measurement, truth, auxiliary, problem = weak_problem(prior)
    solution = solve_surface(
        problem,
        auxiliary,
        truth,
        np.ones(SHAPE),
        coupling_factor=coupling_factor,
        smoothness=smoothness,
        tolerance=1e-8,
        max_steps=200,
    )
    diagonal = (coupling_factor * confidence + measurement).ravel()
    right = (coupling_factor * confidence * auxiliary + measurement * truth).ravel()
    matrix = smoothness * sparse_matrix(assemble_prior(weight, prior)) + sparse.diags(diagonal)
    direct = spsolve(matrix.tocsc(), right).reshape(SHAPE)
    assert solution.residual <= 1e-8
    assert np.abs(solution.depth - direct)[:-4, :-4].max() < 3e-4


def test_warm_start_at_the_solution_takes_no_step():
    *_, truth, auxiliary, problem = weak_problem("rotation_invariant")
    settings = dict(coupling_factor=1.0, smoothness=1.0, max_steps=200)
    first = solve_surface(problem, auxiliary, truth, np.ones(SHAPE), tolerance=1e-9, **settings)
    again = solve_surface(problem, auxiliary, truth, first.depth, tolerance=1e-3, **settings)
    assert again.steps == 0


def test_tighter_tolerance_is_nearer_the_truth():
    """Convergence: the error against a fully converged solve falls with the tolerance."""
    *_, truth, auxiliary, problem = weak_problem("second_order")
    settings = dict(coupling_factor=1.0, smoothness=10.0, max_steps=400)
    reference = solve_surface(problem, auxiliary, truth, np.ones(SHAPE), tolerance=1e-11, **settings).depth
    errors = [
        np.abs(
            solve_surface(problem, auxiliary, truth, np.ones(SHAPE), tolerance=t, **settings).depth - reference
        ).max()
        for t in (1e-2, 1e-4, 1e-6)
    ]
    assert errors[0] > 5 * errors[1] > 25 * errors[2]
