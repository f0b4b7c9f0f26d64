"""Completing depth: pits are closed by their share; the rest is tested in the stage's own body."""

import numpy as np
import pytest

from threedfs.surface.complete import close_pits

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
