"""Oracle and exact: the point-wise search of Eqs. 5-7."""

import numpy as np

from threedfs.depth.search import cheapest_depth, search_depth


def test_search_equals_the_argmin_of_the_energy():
    rng = np.random.default_rng(0)
    cost = rng.random((12, 9, 11)).astype(np.float32)
    candidates = np.geomspace(0.5, 2, 12)
    depth = rng.uniform(0.5, 2, (9, 11))
    found = search_depth(
        cost, candidates, depth, photometric_weight=10.0, coupling=0.05, median_size=1, newton_rate=0.0
    )
    energy = 10.0 * cost + (candidates[:, None, None] - depth) ** 2 / (2 * 0.05)
    assert np.allclose(found, candidates[energy.argmin(0)], rtol=1e-6)


def test_tight_coupling_follows_the_surface():
    """With theta -> 0 the candidate nearest to the surface wins whatever the photometric error says."""
    rng = np.random.default_rng(1)
    candidates = np.linspace(1, 2, 21)
    depth = rng.choice(candidates, (6, 7))
    cost = rng.random((21, 6, 7)).astype(np.float32)
    found = search_depth(cost, candidates, depth, photometric_weight=1.0, coupling=1e-9, median_size=1, newton_rate=0.0)
    assert np.allclose(found, depth, atol=1e-6)


def test_a_full_newton_step_lands_on_the_parabolas_vertex():
    """The cost is a parabola with its vertex between candidates; coupling adds next to nothing."""
    candidates = np.linspace(1, 2, 11)
    vertex = 1.4321
    cost = np.tile(((candidates - vertex) ** 2).astype(np.float32)[:, None, None], (1, 5, 5))
    settings = dict(photometric_weight=1.0, coupling=1e6, median_size=1)
    exact = search_depth(cost, candidates, np.full((5, 5), 1.5), newton_rate=1.0, **settings)
    assert np.allclose(exact, vertex, atol=1e-4)
    damped = search_depth(cost, candidates, np.full((5, 5), 1.5), newton_rate=0.01, **settings)
    assert np.allclose(damped, 1.4 + 0.01 * (vertex - 1.4), atol=1e-4)


def test_the_median_removes_an_outlier():
    candidates = np.linspace(1, 2, 11)
    cost = np.ones((11, 7, 7), np.float32)
    cost[3] = 0
    cost[3, 3, 3] = 1
    cost[9, 3, 3] = 0
    settings = dict(photometric_weight=1.0, coupling=1e6, newton_rate=0.0)
    depth = np.full((7, 7), 1.5)
    assert search_depth(cost, candidates, depth, median_size=1, **settings)[3, 3] > 1.8
    assert abs(search_depth(cost, candidates, depth, median_size=3, **settings)[3, 3] - 1.3) < 1e-6


def test_cheapest_depth_is_the_candidate_of_least_cost():
    """Oracle: against numpy, with ties."""
    rng = np.random.default_rng(3)
    cost, candidates = rng.integers(0, 5, (7, 20, 30)).astype(np.float32), np.linspace(1, 2, 7)
    np.testing.assert_allclose(cheapest_depth(cost, candidates), candidates[cost.argmin(axis=0)], rtol=1e-7)
