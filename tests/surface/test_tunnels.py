"""Narrow tunnels close; pits, wide tunnels and bridges stay."""

import numpy as np
import pytest
from scipy.ndimage import distance_transform_edt

from threedfs.surface.tunnels import _closed_by_ball, close_tunnels

PLATE = np.ones((30, 30, 20), np.float32)
PLATE[3:-3, 3:-3, 6:12] = -1
ABOVE = np.ones(PLATE.shape, bool)


def pierce(*parts):
    field = PLATE.copy()
    for part in parts:
        field[part] = 1
    return field


@pytest.mark.parametrize(("wide", "closes"), [(1, True), (2, True), (3, True), (8, False)])
def test_tunnels_up_to_the_width_close(wide, closes):
    """Exact: a tunnel through a plate."""
    pierced = pierce(np.s_[10 : 10 + wide, 10 : 10 + wide, :])
    field = close_tunnels(pierced, ABOVE, 4.0)
    assert (field[10, 10, 7:11] < 0).all() == closes
    if not closes:
        np.testing.assert_array_equal(field, pierced)


def test_a_pit_of_the_same_width_stays():
    """Exact: it is no tunnel."""
    pitted = pierce(np.s_[10:12, 10:12, 8:])
    np.testing.assert_array_equal(close_tunnels(pitted, ABOVE, 4.0), pitted)


def test_a_groove_beside_a_tunnel_stays():
    """Exact: each piece is judged by itself."""
    both = pierce(np.s_[6:8, 6:8, :], np.s_[:, 20, 10:])
    field = close_tunnels(both, ABOVE, 4.0)
    assert (field[6:8, 6:8, 8] < 0).all()
    np.testing.assert_array_equal(field[3:-3, 20, 11], 1)


def test_nothing_below_the_support_plane_is_filled():
    pierced, above = pierce(np.s_[10:12, 10:12, :]), ABOVE.copy()
    above[:, :, :20] = False
    np.testing.assert_array_equal(close_tunnels(pierced, above, 4.0), pierced)


@pytest.mark.parametrize("field", [np.ones_like(PLATE), -np.ones_like(PLATE)])
def test_of_nothing_and_of_all_nothing_changes(field):
    np.testing.assert_array_equal(close_tunnels(field, ABOVE, 4.0), field)


def test_no_width_is_none():
    pierced = pierce(np.s_[10:12, 10:12, :])
    assert close_tunnels(pierced, ABOVE, 0.0) is pierced


@pytest.mark.parametrize("radius", [1.0, 1.5, 2.0, 2.5])
@pytest.mark.parametrize("threads", [1, 2])
def test_a_closing_adds_what_distances_say(radius, threads):
    """Oracle: two distance transforms, with room around for what grows over the border."""
    rng = np.random.default_rng(4)
    solid, among = rng.random((14, 17, 9)) < 0.15, rng.random((14, 17, 9)) < 0.8
    margin = int(np.ceil(radius)) + 1
    grown = distance_transform_edt(~np.pad(solid, margin)) <= radius
    closed = (distance_transform_edt(grown) > radius)[margin:-margin, margin:-margin, margin:-margin]
    added = _closed_by_ball(solid, among & ~solid, radius, threads)
    np.testing.assert_array_equal(added, closed & among & ~solid)
