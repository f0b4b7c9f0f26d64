"""Voxels near a set: the distance transform is the oracle."""

import numpy as np
import pytest
from scipy.ndimage import distance_transform_edt

from threedfs.geometry.near import find_near


@pytest.mark.parametrize("radius", [1.0, 1.5, 2.0, 3.0])
@pytest.mark.parametrize("threads", [1, 2])
def test_near_voxels_are_those_the_distance_transform_gives(radius, threads):
    """Oracle, on any number of threads; only what is asked for is found."""
    rng = np.random.default_rng(3)
    voxels, among = rng.random((17, 23, 11)) < 0.01, rng.random((17, 23, 11)) < 0.7
    near = find_near(voxels, radius, among, threads)
    np.testing.assert_array_equal(near, among & (distance_transform_edt(~voxels) <= radius))


def test_nothing_is_near_to_nothing():
    assert not find_near(np.zeros((5, 5, 5), bool), 2.0, np.ones((5, 5, 5), bool)).any()
