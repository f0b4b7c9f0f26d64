"""Narrow tunnels close, wider ones where they are hidden; pits, grooves, wide tunnels and bridges stay."""

import numpy as np
import pytest
from scipy.ndimage import distance_transform_edt

from threedfs.surface.tunnels import _closed_by_ball, close_hidden_tunnels, close_tunnels
from threedfs.types import VoxelGrid

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


BLOCK = -np.ones((60, 30, 30), np.float32)
BLOCK[[0, 1, -2, -1]] = BLOCK[:, [0, 1, -2, -1]] = BLOCK[:, :, [0, 1, -2, -1]] = 1


def close_hidden(field, width, threads=1):
    grid = VoxelGrid(np.zeros(3), 1.0, field.shape)
    return close_hidden_tunnels(field, np.ones(field.shape, bool), width, grid, np.array([0.0, 0.0, 1.0]), threads)


@pytest.mark.parametrize(("wide", "closes"), [(3, True), (5, True), (9, False)])
@pytest.mark.parametrize("threads", [1, 2])
def test_a_tunnel_is_plugged_where_it_is_hidden(wide, closes, threads):
    """Exact: from one side of a block to the other; its ends, which see the sky, stay as pits."""
    pierced = BLOCK.copy()
    pierced[:, 12 : 12 + wide, 12 : 12 + wide] = 1
    field = close_hidden(pierced, 6.0, threads)
    assert (field[29:31, 12 : 12 + wide, 12 : 12 + wide] < 0).all() == closes
    assert (field[2:4, 12 : 12 + wide, 12 : 12 + wide] > 0).all()
    assert close_hidden(pierced, 0.0) is pierced


def test_what_lies_open_between_spines_is_not_plugged():
    """Exact: a window through a thin wall, which a closing of this width would fill, sees the sky."""
    wall = BLOCK.copy()
    wall[:13] = wall[16:] = 1
    wall[13:16, 12:15, 20:23] = 1
    assert (close_tunnels(wall, np.ones(wall.shape, bool), 6.0) != wall).any()
    np.testing.assert_array_equal(close_hidden(wall, 6.0), wall)


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
