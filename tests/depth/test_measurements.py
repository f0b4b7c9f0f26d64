"""Exact tests of merging semi-dense depth and stereo matches."""

import inspect

import numpy as np

from threedfs.depth.evidence import gather_evidence
from threedfs.depth.measurements import distrust_unmatched, merge_measurements
from threedfs.depth.solver import optimise_depth
from threedfs.params.depth import DepthParams, matching_settings, solver_settings


def test_merged_by_variance():
    """Exact: alone each map is itself; together they are the mean weighted by the inverse variances."""
    nan = np.nan
    semidense = np.array([[1.0, nan, 1.0, nan]])
    variance = np.array([[0.01, nan, 0.01, nan]])
    stereo = np.array([[nan, 2.0, 2.0, nan]])
    inverse_depth, merged = merge_measurements(semidense, variance, stereo, deviation=0.05)
    np.testing.assert_allclose(inverse_depth, [[1.0, 2.0, 1.5, nan]])
    np.testing.assert_allclose(merged, [[0.01, 0.01, 0.005, nan]])


def test_every_setting_is_taken_by_whom_it_is_handed_to():
    """Contract: what the parameters hand on are arguments of the functions that take them."""
    params = DepthParams()
    assert set(matching_settings(params)) <= set(inspect.signature(gather_evidence).parameters)
    assert set(solver_settings(params)) <= set(inspect.signature(optimise_depth).parameters)


def test_photometric_error_counts_less_without_a_match():
    """Exact: a share where there is no match, untouched where there is one."""
    found = distrust_unmatched(np.array([[0.8, 0.8]]), np.array([[np.nan, 1.2]]), 0.25)
    np.testing.assert_allclose(found, [[0.2, 0.8]])
