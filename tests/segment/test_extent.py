"""Property: images tell how far the object reaches where the field has lost a part of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scene import CENTRE, RADIUS, make_scene
from test_joint import DEFAULTS, rules

from threedfs.geometry.grid import world_from_index
from threedfs.locate.find import stand_on
from threedfs.segment.extent import find_extent


def find(scene, threads: int = 1) -> np.ndarray:
    """Return the voxels that images show to be the object's."""
    gather, cut = rules(replace(DEFAULTS, outer_margin=15, sdf_weight=1.0, iterations=3))
    return find_extent(scene, gather, cut, np.random.default_rng(0), lambda message: None, threads)


def reach(scene) -> float:
    """Return the height up to which images show the object."""
    voxels = find(scene)
    return float(world_from_index(scene.located.grid, np.argwhere(voxels))[:, 2].max())


@pytest.fixture(scope="module")
def whole():
    """The ball on its table, all of it in the field."""
    return make_scene()[0]


def test_an_object_that_the_field_holds_reaches_no_farther(whole):
    assert reach(whole) == pytest.approx(CENTRE[2] + RADIUS, abs=2.5 * whole.located.grid.spacing)


def test_what_the_field_has_lost_is_found_again(whole):
    """The field has the lower half of the ball alone; all images show the whole one."""
    grid, known = whole.located.grid, whole.located.voxels
    lost = np.indices(grid.shape)[2] * grid.spacing + grid.origin[2] > CENTRE[2]
    halved = replace(
        whole,
        sdf=np.where(lost & (whole.sdf < 0.3), np.float32(0.3), whole.sdf),
        located=stand_on(grid, whole.located.plane, known & ~lost, whole.located.least_height),
    )
    left = world_from_index(grid, np.argwhere(halved.located.voxels))[:, 2].max()
    assert left < CENTRE[2] + grid.spacing
    assert reach(halved) > CENTRE[2] + 0.7 * RADIUS


def test_no_number_of_threads_changes_the_extent(whole):
    assert (find(whole) == find(whole, threads=3)).all()
