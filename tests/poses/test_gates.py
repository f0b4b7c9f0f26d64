"""Rejection: each gate stops with a sentence and a hint, and lets good figures pass."""

from __future__ import annotations

import numpy as np
import pytest
from orbit import make_orbit, true_matches

from threedfs.colmap.verification import Verified
from threedfs.errors import UserError
from threedfs.poses import gates
from threedfs.poses.pairs import sequential_pairs
from threedfs.types import Features

GOOD = {"reprojection_error": 0.6, "track_length": 5.0, "triangulation_angle": 12.0}
BOUNDS = {"max_error": 2.0, "min_track_length": 2.5, "min_angle": 2.5}


def features_of(*counts):
    return [Features(np.zeros((n, 2)), np.zeros((n, 128), np.uint8), np.zeros((n, 3), np.uint8)) for n in counts]


def test_blank_frames():
    assert gates.check_features(features_of(0, 100, 100), 50) == 100
    with pytest.raises(UserError, match="blank, dark or blurred"):
        gates.check_features(features_of(0, 3, 100), 50)


def test_static_camera():
    orbit = make_orbit(4, 0.1)
    verified = {pair: Verified(found, None) for pair, found in true_matches(orbit, sequential_pairs(4, 2)).items()}
    assert gates.check_motion(orbit.features, verified, 3.0) > 10
    still = [orbit.features[0]] * 2
    every = np.arange(len(still[0].pixels), dtype=np.uint32)
    with pytest.raises(UserError, match="static"):
        gates.check_motion(still, {(0, 1): Verified(np.column_stack([every, every]), None)}, 3.0)


def test_no_parallax():
    matches = np.zeros((20, 2), np.uint32)
    pairs = {(0, n): Verified(matches, None, flat=n > 1) for n in range(1, 5)}
    assert gates.check_parallax(pairs, 0.8) == 0.75
    with pytest.raises(UserError, match="turns on the spot"):
        gates.check_parallax(pairs, 0.7)


def test_few_matches_agree_with_given_cameras():
    assert gates.check_agreement(60, 100, 0.5) == 0.6
    with pytest.raises(UserError, match=r"40%.*do not fit the images"):
        gates.check_agreement(40, 100, 0.5)


def test_nothing_mapped():
    with pytest.raises(UserError, match="among 3 pairs"):
        gates.check_mapped(None, 3)


def test_few_registered():
    assert gates.check_registered(9, 10, 0.8) == 0.9
    with pytest.raises(UserError, match=r"got 7 of 10.*film slower"):
        gates.check_registered(7, 10, 0.8)


def test_given_cameras_that_do_not_fit():
    gates.check_points(50, 50)
    with pytest.raises(UserError, match="do not fit the images"):
        gates.check_points(49, 50)


@pytest.mark.parametrize(
    ("name", "value", "sentence"),
    [
        ("reprojection_error", 2.5, "mean reprojection error.*2.50"),
        ("track_length", 2.1, "overlap too little"),
        ("triangulation_angle", 1.0, "no parallax"),
    ],
)
def test_bad_figures(name, value, sentence):
    gates.check_quality(GOOD, **BOUNDS)
    with pytest.raises(UserError, match=sentence):
        gates.check_quality({**GOOD, name: value}, **BOUNDS)


@pytest.mark.parametrize("ratio", [9.9, np.inf])
def test_a_path_that_jumps(ratio):
    gates.check_continuity(1.7, 6.0)
    with pytest.raises(UserError, match="continuous camera path"):
        gates.check_continuity(ratio, 6.0)
