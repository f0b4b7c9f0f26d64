"""Exact tests of merging semi-dense depth and stereo matches."""

import numpy as np

from threedfs.depth.measurements import merge_measurements


def test_merged_by_variance():
    """Exact: alone each map is itself; together they are the mean weighted by the inverse variances."""
    nan = np.nan
    semidense = np.array([[1.0, nan, 1.0, nan]])
    variance = np.array([[0.01, nan, 0.01, nan]])
    stereo = np.array([[nan, 2.0, 2.0, nan]])
    inverse_depth, merged = merge_measurements(semidense, variance, stereo, deviation=0.05)
    np.testing.assert_allclose(inverse_depth, [[1.0, 2.0, 1.5, nan]])
    np.testing.assert_allclose(merged, [[0.01, 0.01, 0.005, nan]])
