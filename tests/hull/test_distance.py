"""The hull of masks: a ball seen by a ring of views, some of whose masks are wrong."""

import numpy as np
import pytest

from threedfs.geometry.grid import voxel_centres
from threedfs.geometry.projection import backproject_map
from threedfs.geometry.rigid import look_at
from threedfs.hull.distance import measure_hull
from threedfs.types import Camera, View, VoxelGrid

CAMERA = Camera(120, 120, 150.0, 150.0, 59.5, 59.5)
RADIUS = 0.3
GRID = VoxelGrid(np.full(3, -0.5), 0.025, (41, 41, 41))
RAMP = 4.0


def look(index, count=12):
    angle = 2 * np.pi * index / count
    place = 1.5 * np.array([np.cos(angle), np.sin(angle), np.sin(3 * angle)])
    return View(f"{index:02d}", CAMERA, look_at(place, np.zeros(3), np.array([0.0, 0.0, 1.0])))


def silhouette(view):
    """Say which pixels' rays pass the ball."""
    rays = backproject_map(view, np.ones(view.camera.shape)) - view.centre
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    return np.linalg.norm(np.cross(rays, -view.centre), axis=-1) < RADIUS


@pytest.fixture(scope="module")
def scene():
    views = {view.name: view for view in map(look, range(12))}
    masks = {name: silhouette(view) for name, view in views.items()}
    return views, masks, {name: np.ones_like(mask) for name, mask in masks.items()}


def measure(scene, tolerances=(0.0,), masks=None, valid=None, allowed=None):
    views, right, everywhere = scene
    allowed = np.ones(GRID.shape, bool) if allowed is None else allowed
    return measure_hull(masks or right, views, valid or everywhere, GRID, allowed, ramp=RAMP, tolerances=tolerances)


def distance():
    return np.linalg.norm(voxel_centres(GRID), axis=-1) - RADIUS


def test_the_hull_holds_the_ball_and_hardly_more(scene):
    (field,) = measure(scene)
    assert field.dtype == np.float32 and -1 <= field.min() and field.max() <= 1
    assert (field[distance() < -GRID.spacing] < 0).all()
    assert (field[distance() > 3 * GRID.spacing] > 0).mean() > 0.97


def test_beside_the_ball_the_field_is_the_distance_in_ramps(scene):
    (field,) = measure(scene)
    near = np.abs(distance()) < 0.5 * GRID.spacing
    assert np.abs(field[near] * RAMP * GRID.spacing - distance()[near]).max() < 1.5 * GRID.spacing


def test_with_a_tolerance_wrong_masks_do_not_cut(scene):
    _, right, _ = scene
    wrong = {**right, "03": np.roll(right["03"], 25, axis=1)}
    strict, lenient = measure(scene, (0.0, 0.1), masks=wrong)
    core = distance() < -2 * GRID.spacing
    assert (strict[core] > 0).mean() > 0.1
    assert (lenient[core] < 0).all()


def test_a_tolerance_never_makes_the_hull_smaller(scene):
    none, some, more = measure(scene, (0.0, 0.1, 0.3))
    assert (some <= none + 1e-6).all() and (more <= some + 1e-6).all() and (more < none - 0.01).any()


def test_empty_masks_and_pixels_that_show_nothing_bound_nothing(scene):
    _, right, everywhere = scene
    empty = {**right, "05": np.zeros_like(right["05"])}
    blind = {**everywhere, "05": np.zeros_like(everywhere["05"])}
    (without,) = measure(scene, masks=empty)
    (unseen,) = measure(scene, valid=blind)
    assert (without <= measure(scene)[0] + 1e-6).all()
    np.testing.assert_array_equal(without > 0, unseen > 0)


def test_voxels_that_are_not_asked_for_are_outside(scene):
    upper = voxel_centres(GRID)[..., 2] > 0
    (field,) = measure(scene, allowed=upper)
    assert (field[~upper] == 1).all() and (field[upper] < 0).any()
