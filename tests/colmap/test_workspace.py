"""Oracle tests of COLMAP's workspace: maps of a plane in closed form fuse to points of that plane."""

import numpy as np
import pycolmap
import pytest

from threedfs.colmap.workspace import (
    FusionRule,
    can_match_on_gpu,
    fuse_workspace,
    match_on_gpu,
    write_patch_map,
    write_workspace,
)
from threedfs.errors import UserError
from threedfs.geometry.projection import backproject_map
from threedfs.geometry.rigid import look_at
from threedfs.types import Box, Camera, View

CAMERA = Camera(64, 48, 60.0, 62.0, 30.0, 25.0)
NORMAL = np.array([0.6, 0.0, 0.8])
RULE = FusionRule(min_pixels=3, max_depth_error=0.01, max_reprojection_error=2, max_normal_error=10)
EVERYWHERE = Box(np.eye(3), np.full(3, -2), np.full(3, 2))


def place(x, y):
    return View(f"{x}_{y}", CAMERA, look_at(np.array([x, y, 1.0]), np.zeros(3), np.array([0.0, 1, 0])))


VIEWS = [place(*spot) for spot in ((0.0, 0.0), (0.2, 0.0), (0.0, 0.2), (-0.2, 0.1))]


def plane_depth(view):
    """Depth of the plane through the origin with normal `NORMAL`."""
    rays = backproject_map(view, np.ones(CAMERA.shape)) - view.centre
    return -(view.centre @ NORMAL) / (rays @ NORMAL)


def fill(folder, views=VIEWS):
    rng = np.random.default_rng(0)
    images = {view.name: rng.integers(0, 255, (*CAMERA.shape, 3)).astype(np.uint8) for view in views}
    tracks = [(point, range(len(views))) for point in rng.uniform(-0.1, 0.1, (20, 3))]
    write_workspace(folder, views, images.__getitem__, tracks)
    for view in views:
        normal = np.broadcast_to(view.cam_from_world[:3, :3] @ NORMAL, (*CAMERA.shape, 3))
        write_patch_map(folder, view, plane_depth(view).astype(np.float32), normal)


def test_points_lie_on_the_plane_that_the_maps_show(tmp_path):
    """Exact: half a pixel of principal point more would put them 0.003 off."""
    fill(tmp_path)
    points = fuse_workspace(tmp_path, RULE, EVERYWHERE)
    assert len(points.xyz) > 500
    assert np.abs(points.xyz @ NORMAL).max() < 1e-5
    np.testing.assert_allclose(points.normal, np.broadcast_to(NORMAL, points.normal.shape), atol=1e-5)


def test_points_lie_on_the_rays_of_their_pixels(tmp_path):
    """Exact: one view alone gives back its own pixels."""
    fill(tmp_path)
    alone = FusionRule(1, 1e-9, 1e-9, 1e-9)
    points = fuse_workspace(tmp_path, alone, EVERYWHERE)
    own = points.xyz[points.seen_point[points.seen_view == 0]]
    homogeneous = np.column_stack([own, np.ones(len(own))]) @ VIEWS[0].px_from_world.T
    pixels = homogeneous[:, :2] / homogeneous[:, 2:]
    assert np.abs(pixels - np.round(pixels)).max() < 1e-3


def test_visibility_names_the_views(tmp_path):
    fill(tmp_path)
    points = fuse_workspace(tmp_path, RULE, EVERYWHERE)
    assert set(points.seen_view.tolist()) == {0, 1, 2, 3}
    assert (np.diff(points.seen_point) >= 0).all()
    assert points.sightings.min() >= 1
    assert points.sightings.max() == 4


def test_the_box_bounds_the_points(tmp_path):
    fill(tmp_path)
    points = fuse_workspace(tmp_path, RULE, Box(np.eye(3), np.full(3, -0.1), np.full(3, 0.05)))
    assert len(points.xyz)
    assert points.xyz.min() >= -0.1
    assert points.xyz.max() <= 0.05


def test_a_box_aslant_bounds_the_points(tmp_path):
    """Exact: none outside of it, though COLMAP's box along the axes holds more, and each with the views that see it."""
    fill(tmp_path)
    half = np.sqrt(0.5)
    aslant = Box(np.array([[half, half, 0], [-half, half, 0], [0, 0, 1]]), np.full(3, -0.1), np.full(3, 0.06))
    corners = aslant.corners()
    around = Box(np.eye(3), corners.min(axis=0), corners.max(axis=0))
    points, more = (fuse_workspace(tmp_path, RULE, box) for box in (aslant, around))
    along = more.xyz @ aslant.axes.T
    inside = ((along >= -0.1) & (along <= 0.06)).all(axis=1)
    assert 0 < inside.sum() < len(inside)
    np.testing.assert_array_equal(points.xyz, more.xyz[inside])
    np.testing.assert_array_equal(points.sightings, more.sightings[inside])


def test_maps_that_disagree_make_no_points(tmp_path):
    fill(tmp_path)
    for number, view in enumerate(VIEWS):
        depth = plane_depth(view) * (1 + 0.1 * number)
        write_patch_map(tmp_path, view, depth.astype(np.float32), np.broadcast_to([0, 0, -1.0], (*CAMERA.shape, 3)))
    points = fuse_workspace(tmp_path, RULE, EVERYWHERE)
    assert len(points.xyz) == 0
    assert points.seen_point.shape == (0,)


def test_an_empty_map_is_left_out(tmp_path):
    fill(tmp_path)
    write_patch_map(tmp_path, VIEWS[0], np.full(CAMERA.shape, np.nan), np.full((*CAMERA.shape, 3), np.nan))
    points = fuse_workspace(tmp_path, RULE, EVERYWHERE)
    assert 0 not in points.seen_view


def test_equal_maps_give_equal_points(tmp_path):
    fill(tmp_path / "a")
    fill(tmp_path / "b")
    first, second = (fuse_workspace(tmp_path / name, RULE, EVERYWHERE) for name in "ab")
    for name, values in vars(first).items():
        np.testing.assert_array_equal(values, getattr(second, name), err_msg=name)


@pytest.mark.skipif(not can_match_on_gpu(), reason="COLMAP's own patch match needs CUDA and a GPU")
def test_colmap_matches_patches_where_there_is_cuda(tmp_path):
    """Oracle: of a textured plane its points lie on the plane, in the same form as ours."""
    rng = np.random.default_rng(0)
    texture = rng.integers(0, 255, (200, 200, 3)).astype(np.uint8)

    def draw(name):
        view = next(view for view in VIEWS if view.name == name)
        spots = backproject_map(view, plane_depth(view))[..., :2]
        column, row = np.moveaxis(np.clip((spots + 1) * 100, 0, 199).astype(int), -1, 0)
        return texture[row, column]

    points = [backproject_map(VIEWS[0], plane_depth(VIEWS[0]))[row, 8 * row] for row in range(1, 8)]
    write_workspace(tmp_path, VIEWS, draw, [(point, range(len(VIEWS))) for point in points])
    match_on_gpu(tmp_path, window_radius=3)
    found = fuse_workspace(tmp_path, RULE, EVERYWHERE)
    assert len(found.xyz) > 50
    assert np.median(np.abs(found.xyz @ NORMAL)) < 0.01


@pytest.mark.parametrize(
    ("built", "gpus", "can", "found"),
    [(False, 0, False, "one built without"), (True, 0, False, "no GPU"), (True, 1, True, None)],
)
def test_matching_on_the_gpu_needs_both_cuda_and_a_gpu(tmp_path, monkeypatch, built, gpus, can, found):
    """Rejection: COLMAP with CUDA ends the process where there is no GPU."""
    monkeypatch.setattr(pycolmap, "has_cuda", built)
    monkeypatch.setattr(pycolmap, "get_num_cuda_devices", lambda: gpus, raising=False)
    assert can_match_on_gpu() == can
    if not can:
        with pytest.raises(UserError, match=f"built with CUDA, and a GPU, found {found}; set it to cpu"):
            match_on_gpu(tmp_path, window_radius=3)
