"""Exact and oracle tests of the implicit shapes."""

import numpy as np
import pytest

from threedfs.synthetic import fields

POINTS = np.random.default_rng(0).uniform(-1, 1, (500, 3))


def test_round_cone_is_the_hull_of_its_balls():
    a, b = np.array([-0.3, 0.1, 0.0]), np.array([0.4, 0.0, 0.3])
    share = np.linspace(0, 1, 20001)[:, None]
    centres, radii = a + share * (b - a), 0.3 + share[:, 0] * (0.1 - 0.3)
    oracle = [np.min(np.linalg.norm(p - centres, axis=1) - radii) for p in POINTS]
    # The sampled balls are 4e-5 apart: the nearest is missed by at most their second-order gap.
    np.testing.assert_allclose(fields.round_cone(a, b, 0.3, 0.1)(POINTS), oracle, atol=1e-6)


def test_round_cone_with_one_ball_inside_the_other_is_the_larger_ball():
    cone = fields.round_cone((0, 0, 0), (0, 0, 0.1), 0.5, 0.2)
    np.testing.assert_allclose(cone(POINTS), fields.sphere((0, 0, 0), 0.5)(POINTS))


@pytest.mark.parametrize(
    ("field", "point", "distance"),
    [
        (fields.sphere((0, 0, 1), 0.5), (0, 0, 2), 0.5),
        (fields.box((0, 0, 0), (1, 2, 3)), (1 + 3, 2 + 4, 0), 5.0),
        (fields.box((0, 0, 0), (1, 2, 3)), (0.8, 0, 0), -0.2),
        (fields.box((0, 0, 0), (1, 1, 1), 0.5), (1, 1, 0.5), 0.5 * (np.sqrt(2) - 1)),
        (fields.cylinder((0, 0, -1), (0, 0, 1), 0.5), (0.5 + 3, 0, 1 + 4), 5.0),
        (fields.cylinder((0, 0, -1), (0, 0, 1), 0.5), (0, 0, 0.9), -0.1),
        (fields.torus((0, 0, 0), (0, 0, 1), 1.0, 0.25), (2, 0, 0), 0.75),
        (fields.torus((0, 0, 0), (1, 0, 0), 1.0, 0.25), (0, 1, 0), -0.25),
        (fields.half_space((0, 0, 1), (0, 0, 2)), (5, 5, 3), 2.0),
        (fields.ellipsoid((0, 0, 0), (1, 2, 3)), (0, 2, 0), 0.0),
    ],
)
def test_distance_in_closed_form(field, point, distance):
    assert field(np.array([point], float))[0] == pytest.approx(distance, abs=1e-12)


def test_combinations():
    a, b = fields.sphere((0, 0, 0), 0.6), fields.box((0.5, 0, 0), (0.4, 0.4, 0.4))
    in_a, in_b = a(POINTS) < 0, b(POINTS) < 0
    assert np.array_equal(fields.union(a, b)(POINTS) < 0, in_a | in_b)
    assert np.array_equal(fields.intersection(a, b)(POINTS) < 0, in_a & in_b)
    assert np.array_equal(fields.subtract(a, b)(POINTS) < 0, in_a & ~in_b)
    blended = fields.smooth_union(0.1, a, b)(POINTS)
    plain = fields.union(a, b)(POINTS)
    far = np.abs(a(POINTS) - b(POINTS)) >= 0.1
    np.testing.assert_array_equal(blended[far], plain[far])
    assert np.all(blended <= plain) and np.all(plain - blended <= 0.1 / 4 + 1e-12)


def test_place_moves_and_mirror_repeats():
    turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    bar = fields.place(fields.box((0, 0, 0), (1, 0.1, 0.1)), (0, 0, 2), turn)
    assert bar(np.array([[0, 0.9, 2.0]]))[0] < 0 < bar(np.array([[0.9, 0, 2.0]]))[0]
    pair = fields.mirror_x(fields.sphere((0.5, 0, 0), 0.2))
    np.testing.assert_allclose(pair(POINTS), pair(POINTS * [-1, 1, 1]))
