"""Exact and property: continuity and turns of a camera path."""

from __future__ import annotations

import numpy as np
import pytest

from threedfs.geometry.rigid import camera_centres, look_at, make_transform
from threedfs.poses.continuity import step_ratio, turns_around


def path_of(angles):
    """Return poses on a circle of radius 3 that look at its middle."""
    centres = 3 * np.column_stack([np.cos(angles), np.sin(angles), np.full(len(angles), 0.4)])
    return np.array([look_at(centre, np.zeros(3), np.array([0, 0, 1.0])) for centre in centres])


def shifted(x):
    """Return poses with centres at (x, 0, 0)."""
    return np.array([make_transform(np.eye(3), [-value, 0, 0]) for value in x])


def test_centres():
    np.testing.assert_allclose(camera_centres(shifted([1.0, 2.0]))[:, 0], [1, 2])


def test_uniform_motion_has_ratio_one():
    assert step_ratio(np.arange(30) / 30, path_of(np.linspace(0, 1, 30)), 0.1) == pytest.approx(1, abs=1e-6)


def test_a_jump_is_counted_in_median_steps():
    assert step_ratio(np.arange(5.0), shifted([0.0, 1, 2, 5, 6]), 1.0) == pytest.approx(3)


def test_missing_and_extra_frames_do_not_change_the_ratio():
    times = np.arange(60) / 10
    chosen = np.sort(np.random.default_rng(0).choice(60, 40, replace=False))
    poses = path_of(times * 0.4)
    # Chords over gaps are shorter than the arc by less than half a percent.
    assert step_ratio(times[chosen], poses[chosen], 0.5) == pytest.approx(1, abs=0.01)


def test_a_folded_path_shows():
    angles = np.linspace(0, 1.6 * 2 * np.pi, 71)
    folded = np.where(np.arange(71) >= 30, angles - np.pi, angles)
    assert step_ratio(np.arange(71) / 3, path_of(folded), 1 / 3) > 9


def test_a_camera_that_rests_and_jumps_has_an_infinite_ratio():
    assert step_ratio(np.arange(6.0), shifted([0.0, 0, 0, 0, 0, 1]), 1.0) == np.inf


def test_too_few_frames_have_no_ratio():
    assert np.isnan(step_ratio(np.arange(2.0), shifted([0.0, 1.0]), 1.0))


@pytest.mark.parametrize("turns", [0.3, 1.0, 1.6, 2.5])
def test_turns_are_counted(turns):
    poses = path_of(np.linspace(0, turns * 2 * np.pi, 80))
    assert turns_around(poses) == pytest.approx(turns, rel=1e-6)
    assert turns_around(poses[::-1]) == pytest.approx(turns, rel=1e-6)
