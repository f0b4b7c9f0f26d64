"""Exact test of which matches are kept."""

import numpy as np

from threedfs.stereo.confirm import confirm_matches


def test_matches_are_kept_by_cost_and_agreement():
    """Exact: a match needs both, with equality."""
    depth, slope = np.array([[1.0, 2.0, 3.0, np.nan]]), np.ones((1, 4, 2))
    cost, agreeing = np.array([[0.1, 0.1, 0.2, 0.1]]), np.array([[2, 1, 3, 3]])
    kept, slopes = confirm_matches(depth, slope, cost, agreeing, max_cost=0.1, min_agreeing=2)
    np.testing.assert_array_equal(kept, [[1.0, np.nan, np.nan, np.nan]])
    np.testing.assert_array_equal(np.isfinite(slopes).all(axis=-1), [[True, False, False, True]])
