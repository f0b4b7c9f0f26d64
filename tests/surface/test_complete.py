"""Completing depth: pits, trust around gaps; the rest is tested in the stage's own body."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter, generate_binary_structure, grey_closing

from threedfs.surface.complete import _trust_around, close_pits

FIELD = np.where(np.indices((12, 12, 12))[0] < 6, np.float32(-1), np.float32(1))


def test_a_narrow_pit_closes_up_to_its_mouth_and_a_spike_stays():
    """Exact: a closing only adds; half of it goes half of the way."""
    rough = FIELD.copy()
    rough[2:6, 6, 6] = 1
    rough[6, 3, 3] = -1
    whole, half = close_pits(rough, 1.0), close_pits(rough, 0.5)
    assert (whole[2:5, 6, 6] == -1).all() and whole[6, 3, 3] == -1
    assert (whole <= rough).all()
    np.testing.assert_array_equal(half, (rough + whole) / 2)
    np.testing.assert_array_equal(close_pits(rough, 0.0), rough)


@pytest.mark.parametrize("width", [2, 4])
def test_tunnels_close_but_wide_ones(width):
    """Exact: a tunnel two voxels wide goes, one of four stays."""
    pierced = np.full((12, 12, 12), np.float32(-1))
    pierced[:, 4 : 4 + width, 4 : 4 + width] = 1
    left = close_pits(pierced, 1.0)[6, 4 : 4 + width, 4 : 4 + width]
    assert (left < 0).all() == (width == 2)


def test_what_is_flat_stays():
    np.testing.assert_array_equal(close_pits(FIELD, 1.0), FIELD)


def test_pits_close_as_by_a_grey_closing():
    """Oracle: of the negative field, by a voxel and the 6 beside it."""
    field = np.random.default_rng(1).uniform(-1, 1, (9, 11, 7)).astype(np.float32)
    closed = -grey_closing(-field, footprint=generate_binary_structure(3, 1), mode="nearest")
    np.testing.assert_array_equal(close_pits(field, 1.0), field + np.float32(1) * (closed - field))


@pytest.mark.parametrize("corner", [(0, 0, 0), (20, 15, 11), (9, 8, 30)])
def test_trust_around_gaps_is_that_of_a_blur_of_the_whole_grid(corner):
    """Oracle, to the last bit: at the border of the grid as well."""
    gaps = np.zeros((40, 30, 40), bool)
    gaps[tuple(slice(low, low + 3) for low in corner)] = True
    gaps[12, 14, 20] = True
    whole = np.clip(1.5 * gaussian_filter(gaps.astype(np.float64), 1.0), 0, 1)
    np.testing.assert_array_equal(_trust_around(gaps), whole)
    assert not _trust_around(np.zeros((4, 4, 4), bool)).any()
