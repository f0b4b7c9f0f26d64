"""Exact and rejection: candidate depths and the weights of Eqs. 9-12."""

import numpy as np
import pytest

from threedfs.depth.candidates import SPACINGS, space_candidates
from threedfs.depth.weights import (
    coupling_schedule,
    edge_weight,
    measurement_weight,
    photometric_confidence,
    smoothness_at,
    texture_confidence,
)
from threedfs.errors import UserError


@pytest.mark.parametrize("spacing", SPACINGS)
def test_candidates_ascend_from_near_to_far(spacing):
    candidates = space_candidates(0.7, 2.5, 33, spacing)
    assert candidates[0] == pytest.approx(0.7) and candidates[-1] == pytest.approx(2.5)
    assert np.all(np.diff(candidates) > 0)


def test_power_spacing_is_the_papers():
    """(0.2 + 0.8 i / l)^5 up to the affine map onto the range: ratios of steps are unchanged by it."""
    expected = np.diff((0.2 + 0.8 * np.arange(1, 11) / 10) ** 5)
    steps = np.diff(space_candidates(1.0, 3.0, 10, "power"))
    assert np.allclose(steps / steps[0], expected / expected[0])


@pytest.mark.parametrize("spacing", SPACINGS)
def test_steps_are_shorter_where_the_object_is(spacing):
    """By one factor everywhere in the coordinate that is even without it; a factor of 1 changes nothing."""
    within, count = (1.2, 1.6), 400
    candidates = space_candidates(0.7, 2.5, count, spacing, within, 4.0)
    assert candidates[0] == pytest.approx(0.7) and candidates[-1] == pytest.approx(2.5)
    even = space_candidates(0.7, 2.5, 5000, spacing)
    steps = np.diff(np.interp(candidates, even, np.arange(5000)))
    inside = (candidates[:-1] > 1.2) & (candidates[1:] < 1.6)
    outside = (candidates[1:] < 1.2) | (candidates[:-1] > 1.6)
    assert np.allclose(steps[inside], steps[inside][0], rtol=0.05)
    assert np.allclose(steps[outside], 4 * steps[inside][0], rtol=0.05)
    np.testing.assert_array_equal(
        space_candidates(0.7, 2.5, 64, spacing, within, 1.0), space_candidates(0.7, 2.5, 64, spacing)
    )


def test_a_box_that_ends_out_of_the_range_is_cut_off():
    candidates = space_candidates(1.0, 2.0, 33, "inverse", (0.5, 3.0), 4.0)
    assert np.allclose(candidates, space_candidates(1.0, 2.0, 33, "inverse"))


@pytest.mark.parametrize("near, far", [(0.0, 1.0), (2.0, 1.0), (-1.0, 1.0), (np.nan, 1.0)])
def test_an_empty_range_is_refused(near, far):
    with pytest.raises(UserError, match="expected 0 < near < far"):
        space_candidates(near, far, 8, "inverse")


def test_an_unknown_spacing_is_refused():
    with pytest.raises(UserError, match=r"depth\.spacing: expected one of power, inverse, log, got cubic"):
        space_candidates(1, 2, 8, "cubic")


def test_coupling_follows_the_papers_recursion():
    """theta_t = (1 - 0.03 t) theta_(t-1): after 20 iterations 2.6e-4 of the first."""
    schedule = coupling_schedule(1.0, 0.03, 20)
    theta = 1.0
    for t in range(1, 21):
        theta *= 1 - 0.03 * t
        assert schedule[t - 1] == pytest.approx(theta, rel=1e-12)


def test_coupling_read_as_a_straight_line_leaves_room_for_smoothing():
    """theta_t = (1 - 0.03 t) theta_0: more than half of the first is left after 15 iterations, 4 % by the recursion."""
    schedule = coupling_schedule(2.0, 0.03, 15, "linear")
    assert schedule == pytest.approx([2 * (1 - 0.03 * t) for t in range(1, 16)], rel=1e-12)
    assert coupling_schedule(2.0, 0.03, 15)[-1] < 0.04 * schedule[-1] / 0.55


def test_a_schedule_that_reaches_zero_is_refused():
    with pytest.raises(UserError, match="stays positive"):
        coupling_schedule(1.0, 0.03, 34)


def test_weights_at_known_values():
    assert smoothness_at(1, 0.01, 1.6) == 0.01
    assert smoothness_at(3, 0.01, 1.6) == pytest.approx(0.01 * 1.6**2)
    assert photometric_confidence(np.array([0.2]), 5.0)[0] == pytest.approx(np.exp(-1))
    assert edge_weight(np.array([0.0, 1.0]), 5.0) == pytest.approx([1, np.exp(-5)])
    assert list(measurement_weight(np.array([0.01, np.nan]), 0.1)) == pytest.approx([10, 0])
    assert texture_confidence(np.array([10.0, 0.0]), 10.0) == pytest.approx([0.5, 0])
    assert texture_confidence(np.array([10.0, 0.0]), 0.0) == pytest.approx([1, 1])
