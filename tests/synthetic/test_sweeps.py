"""Exact and oracle tests of shapes drawn by curves and outlines."""

import numpy as np
import pytest

from threedfs.synthetic import fields, sweeps

RNG = np.random.default_rng(0)
POINTS = RNG.uniform(-1, 1, (400, 3))


def test_spline_goes_through_its_knots_and_keeps_lines_straight():
    knots = RNG.uniform(-1, 1, (5, 3))
    np.testing.assert_allclose(sweeps.spline(knots, 4)[::4], knots, atol=1e-15)
    np.testing.assert_allclose(sweeps.spline(knots, 4, closed=True)[::4], knots, atol=1e-15)
    line = np.outer(np.arange(4), (1.0, 2.0))
    np.testing.assert_allclose(sweeps.spline(line, 5), np.outer(np.linspace(0, 3, 16), (1.0, 2.0)), atol=1e-14)


def test_closed_spline_of_a_square_has_its_symmetry():
    square = np.array([[1.0, 0], [0, 1], [-1, 0], [0, -1]])
    curve = sweeps.spline(square, 6, closed=True)
    turned = np.column_stack([-curve[:, 1], curve[:, 0]])
    np.testing.assert_allclose(np.roll(turned, 6, axis=0), curve, atol=1e-14)


def test_round_cones_are_the_union_of_single_ones():
    a, b = RNG.uniform(-0.5, 0.5, (2, 6, 3))
    radii = RNG.uniform(0.05, 0.3, (2, 6))
    b[0] = a[0]  # a ball in a ball
    radii[:, 1] = (0.9, 0.1)  # the end inside the start
    radii[:, 2] = (0.1, 0.9)
    b[1:3] = a[1:3] + 0.1
    single = [fields.sphere(a[0], radii[:, 0].max())]
    single += [fields.round_cone(a[m], b[m], radii[0, m], radii[1, m]) for m in range(1, 6)]
    field = sweeps.round_cones(zip(a, b, *radii, strict=True))
    np.testing.assert_allclose(field(POINTS), fields.union(*single)(POINTS), atol=1e-12)


def test_straight_tube_is_a_capsule():
    ends = [(0, 0, -0.6), (0, 0, 0), (0, 0, 0.6)]
    capsule = fields.round_cone(ends[0], ends[2], 0.2, 0.2)
    np.testing.assert_allclose(sweeps.tube(ends, (0.2, 0.2, 0.2))(POINTS), capsule(POINTS), atol=1e-12)


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("rounding", [0.0, 0.1])
def test_prism_of_a_rectangle_is_a_box(axis, rounding):
    outline = np.array([(-0.4, -0.3), (0.4, -0.3), (0.4, 0.3), (-0.4, 0.3)])
    half = np.insert([0.4, 0.3], axis, 0.2)
    shape = sweeps.prism(outline, -0.2, 0.2, axis, rounding)(POINTS)
    if rounding == 0:
        np.testing.assert_allclose(shape, fields.box((0, 0, 0), half)(POINTS), atol=1e-12)
    # Faces stay where they were; only rims recede.
    centres = np.concatenate([np.diag(half), -np.diag(half)])
    np.testing.assert_allclose(sweeps.prism(outline, -0.2, 0.2, axis, rounding)(centres), 0, atol=1e-12)
    rim = np.insert([0.4, 0.0], axis, 0.2)[None]
    receded = (np.sqrt(2) - 1) * rounding
    assert sweeps.prism(outline, -0.2, 0.2, axis, rounding)(rim)[0] == pytest.approx(receded, abs=1e-12)


def test_prism_of_an_outline_with_a_notch_leaves_it_open():
    outline = np.array([(0, 0), (2, 0), (2, 1), (1, 0.4), (0, 1.0)])
    for corners in (outline, outline[::-1]):
        value = sweeps.prism(corners, -1, 1)(np.array([(1, 0.9, 0), (1, 0.3, 0), (0.2, 0.5, 0)]))
        assert value[0] > 0 > value[1] and value[2] == pytest.approx(-0.2)
