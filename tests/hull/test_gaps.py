"""Gaps that masks show are filled, unless more masks show what is there to be outside."""

import numpy as np
import pytest

from threedfs.geometry.grid import voxel_centres
from threedfs.geometry.rigid import look_at
from threedfs.hull.gaps import find_gaps
from threedfs.segment.outline import draw_voxels
from threedfs.types import Camera, View, VoxelGrid

CAMERA = Camera(120, 120, 150.0, 150.0, 59.5, 59.5)
GRID = VoxelGrid(np.full(3, -0.5), 0.025, (41, 41, 41))
PLACES = voxel_centres(GRID)
BALL = np.linalg.norm(PLACES, axis=-1) < 0.25
LUMP = np.linalg.norm(PLACES - (0, 0, 0.3), axis=-1) < 0.12
EVERYWHERE = np.ones(GRID.shape, bool)


def look_from(angle):
    centre = 1.5 * np.array([np.cos(angle), np.sin(angle), 0.2])
    return View(f"{angle:.2f}", CAMERA, look_at(centre, np.zeros(3), np.array([0.0, 0, 1])))


VIEWS = {view.name: view for view in (look_from(angle) for angle in 2 * np.pi * np.arange(12) / 12)}
WITHOUT, WITH = draw_voxels(BALL, GRID, VIEWS), draw_voxels(BALL | LUMP, GRID, VIEWS)


def fill(shown, odds, least_views=2):
    """Return the share of the lump that is filled where the first `shown` of twelve masks show it."""
    masks = {name: (WITH if rank < shown else WITHOUT)[name] for rank, name in enumerate(VIEWS)}
    hull = np.where(BALL | LUMP, np.float32(-1), np.float32(1))
    filled = find_gaps(BALL, hull, EVERYWHERE, masks, VIEWS, GRID, least_views, odds)
    assert not (filled & ~LUMP).any()
    top = LUMP & (PLACES[..., 2] > 0.3)
    return filled[top].mean()


@pytest.mark.parametrize(
    ("shown", "odds", "filled"), [(3, 0.0, True), (3, 2.0, False), (10, 2.0, True), (10, 9.0, False)]
)
def test_a_lump_is_filled_where_masks_that_show_it_outnumber_those_that_do_not(shown, odds, filled):
    assert (fill(shown, odds) > 0.95) == filled
    assert filled or fill(shown, odds) < 0.05


def test_the_least_number_of_views_holds_whatever_the_odds():
    assert fill(3, 0.0, least_views=4) == 0 == fill(12, 0.0, least_views=13)
    assert fill(12, 9.0) > 0.95


def test_masks_that_show_nothing_count_against_nothing():
    """Property: an empty mask is no evidence, as in the hull."""
    masks = {name: WITH[name] if rank < 3 else np.zeros_like(WITH[name]) for rank, name in enumerate(VIEWS)}
    hull = np.where(BALL | LUMP, np.float32(-1), np.float32(1))
    filled = find_gaps(BALL, hull, EVERYWHERE, masks, VIEWS, GRID, 2, 9.0)
    assert filled[LUMP & (PLACES[..., 2] > 0.3)].mean() > 0.95
