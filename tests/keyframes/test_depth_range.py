"""The depths to expect."""

from __future__ import annotations

import numpy as np
import pytest

from threedfs.errors import UserError
from threedfs.keyframes.depth_range import expect_depth_range


def test_range_widens_the_percentiles():
    """Exact: 101 evenly spaced depths have their percentiles at known values; NaN do not count."""
    depths = np.append(np.linspace(1.0, 2.0, 101), [np.nan] * 50)
    near, far = expect_depth_range(depths, 0.5, 1.2, "000000")
    np.testing.assert_allclose((near, far), (0.5 * 1.01, 1.2 * 1.97), rtol=1e-12)


def test_one_stray_point_does_not_stretch_the_range():
    """Property: a point a thousand times farther among a hundred moves the far end little."""
    depths = np.append(np.linspace(1.0, 2.0, 100), 2000.0)
    assert expect_depth_range(depths, 0.5, 1.2, "000000")[1] < 2.5


def test_a_view_without_points_is_refused():
    """Rejection: the sentence names the keyframe and the number of points."""
    with pytest.raises(UserError, match="keyframe 000070: expected at least 10 sparse points in view, got 2"):
        expect_depth_range(np.array([1.0, 2.0, np.nan]), 0.5, 1.2, "000070")
