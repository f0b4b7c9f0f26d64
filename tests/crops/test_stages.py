"""Contract, exact: the stages shrink and crops on photos of a board drawn through a lens."""

import cv2
import numpy as np
import pytest

from threedfs.crops.place import find_window
from threedfs.frames.scale import scale_camera
from threedfs.geometry.distortion import undistort
from threedfs.geometry.projection import pixel_grid, project
from threedfs.geometry.rigid import look_at
from threedfs.geometry.similarity import Similarity
from threedfs.io.crops import read_crops
from threedfs.io.frames import Frame, write_frames
from threedfs.io.keyframes import read_keyframes, read_needs_stereo, read_object_pixels, write_keyframes
from threedfs.io.points import write_points
from threedfs.io.poses import Poses, write_poses
from threedfs.io.volumes import write_support
from threedfs.job import Job
from threedfs.params.crops import CropsParams
from threedfs.params.shrink import ShrinkParams
from threedfs.progress import Progress
from threedfs.segment.source_mask import distort_masks
from threedfs.stages import crops as crops_stage
from threedfs.stages import shrink as shrink_stage
from threedfs.types import Box, Camera, Keyframe, Plane, SparsePoints, Support, View

JOB = Job(Progress("test"), {"provenance": "test"})
SOURCE = (480, 640)
WORKING = Camera(320, 240, 300.0, 300.0, 158.0, 121.0)
"""Poses are of frames of half the size."""
BOX = Box(np.eye(3), np.full(3, -0.15), np.full(3, 0.15))
DISC = 0.12
"""Radius of a disc in the plane z = 0, facing all cameras."""
BENT = (-0.15, 0.02)


def look_from(name, centre, target=(0.0, 0.0, 0.0)):
    return View(name, WORKING, look_at(np.array(centre), np.array(target), np.array([0.0, 1.0, 0.1])))


VIEWS = [
    look_from("a", [0.0, 0.1, -1.2]),
    look_from("b", [0.4, -0.1, -1.5]),
    look_from("c", [-0.4, 0.0, -1.0], [-0.1, 0.05, 0.0]),
    look_from("away", [0.0, 0.0, -1.0], [3.0, 0.0, 0.0]),
    look_from("unused", [0.1, 0.0, -1.1]),
]


def film(view, distortion):
    """Draw the frame (480, 640, 3) of a view as its lens shows the disc on a board, and the disc's mask in it."""
    camera = scale_camera(view.camera, SOURCE, "test")
    raw = (np.stack(pixel_grid(camera), axis=-1) - (camera.cx, camera.cy)) / (camera.fx, camera.fy)
    rays = np.dstack([undistort(raw, distortion), np.ones(SOURCE)]) @ view.cam_from_world[:3, :3]
    away = np.where(rays[..., 2] > 0, -view.centre[2] / np.maximum(rays[..., 2], 1e-6), np.inf)
    x, y = (view.centre[axis] + np.minimum(away, 1e3) * rays[..., axis] for axis in (0, 1))
    disc = np.hypot(x, y) < DISC
    board = 110 + 50 * np.sin(25 * x) * np.cos(20 * y)
    image = np.where(disc[..., None], (230, 40, 30), np.dstack([board, board, 200 - board]))
    return np.where(np.isfinite(away)[..., None], image, 60).astype(np.uint8), disc


@pytest.fixture(params=[(0.0, 0.0), BENT], ids=["pinhole", "lens"])
def scene(request, tmp_path):
    """What both stages read; the distortion is the parameter."""
    distortion = request.param
    filmed = {view.name: film(view, distortion) for view in VIEWS}
    (tmp_path / "photos").mkdir()
    for name, (image, _) in filmed.items():
        cv2.imwrite(str(tmp_path / "photos" / f"{name}.png"), image[..., ::-1])
    small = {name: cv2.resize(image, (320, 240), interpolation=cv2.INTER_AREA) for name, (image, _) in filmed.items()}
    frames = [Frame(view.name, rank, np.nan, 1.0, small[view.name]) for rank, view in enumerate(VIEWS)]
    write_frames(tmp_path / "frames.zarr.zip", frames, {}, ordered=False, source_shape=SOURCE)
    write_poses(
        tmp_path / "poses.json", Poses(tuple(VIEWS), (), distortion, Similarity(1.0, np.eye(3), np.zeros(3))), {}
    )
    a, b, c, away, _ = VIEWS
    entries = [Keyframe(a, (b, c), 0.3, 4.0), Keyframe(c, (a, away), 0.25, 5.0), Keyframe(away, (a,), 0.2, 6.0)]
    write_keyframes(tmp_path / "keyframes.json", entries, {}, needs_stereo=True)
    plane = Plane(np.array([0.0, 0.0, -1.0]), 0.2)
    write_support(tmp_path / "support.json", Support(plane, BOX, {"plane_noise": 0.001}), {})
    xyz = np.random.default_rng(0).uniform([-0.4, -0.4, 0.0], [0.4, 0.4, 0.6], (300, 3))
    nothing = np.zeros(0, np.int64)
    points = SparsePoints(xyz, np.zeros((300, 3), np.uint8), np.zeros(300), nothing, nothing)
    write_points(tmp_path / "points.zarr.zip", points, {})
    return tmp_path, distortion, filmed, {entry.view.name: entry for entry in entries}


def cut(folder, support=True, **changes):
    """Run the stage crops; return what it wrote."""
    crops_stage.run(
        source=folder / "photos",
        poses=folder / "poses.json",
        points=folder / "points.zarr.zip",
        keyframes=folder / "keyframes.json",
        support=folder / "support.json" if support else None,
        crops=folder / "crops.zarr.zip",
        views=folder / "views.json",
        frame_far_factor=1.2,
        params=CropsParams(**changes),
        job=JOB,
    )
    return read_crops(folder / "crops.zarr.zip"), read_keyframes(folder / "views.json")


def all_views(entries):
    return {view.name: view for entry in entries.values() for view in (entry.view, *entry.neighbours)}


def check_store(store, entries, before):
    """Every keyframe and neighbour has a crop of its view's size, all else is as before."""
    views = all_views(entries)
    assert set(store.names) == set(views) == {"a", "b", "c", "away"}
    assert not store.ordered and store.source_shape == SOURCE
    for name, view in views.items():
        assert store.image(name).shape == (*view.camera.shape, 3)
        assert store.valid_of(name).shape == view.camera.shape
    assert list(entries) == list(before)
    for name, entry in entries.items():
        assert [view.name for view in entry.neighbours] == [view.name for view in before[name].neighbours]
        np.testing.assert_array_equal(entry.view.cam_from_world, before[name].view.cam_from_world)
    return views


def disc_in(view):
    """Say which pixels of an ideal view see the disc."""
    camera = view.camera
    ideal = (np.stack(pixel_grid(camera), axis=-1) - (camera.cx, camera.cy)) / (camera.fx, camera.fy)
    rays = np.dstack([ideal, np.ones(camera.shape)]) @ view.cam_from_world[:3, :3]
    points = view.centre - (view.centre[2] / rays[..., 2])[..., None] * rays
    return np.hypot(points[..., 0], points[..., 1]) < DISC


def is_red(image):
    return (image[..., 0] > 180) & (image[..., 1] < 90)


def overlap(one, other):
    return (one & other).sum() / (one | other).sum()


def test_small_frames_are_undistorted_views(scene):
    folder, _, _, before = scene
    shrink_stage.run(
        frames=folder / "frames.zarr.zip",
        poses=folder / "poses.json",
        keyframes=folder / "keyframes.json",
        crops=folder / "crops.zarr.zip",
        views=folder / "views.json",
        params=ShrinkParams(longest_side=160),
        job=JOB,
    )
    store, entries = read_crops(folder / "crops.zarr.zip"), read_keyframes(folder / "views.json")
    views = check_store(store, entries, before)
    assert {view.camera.shape for view in views.values()} == {(120, 160)}
    assert [(e.near, e.far, e.within) for e in entries.values()] == [(e.near, e.far, None) for e in before.values()]
    assert read_needs_stereo(folder / "views.json")
    for name in ("a", "b", "c"):
        assert overlap(is_red(store.image(name)), disc_in(views[name])) > 0.85
        assert store.valid_of(name).mean() > 0.8


def test_crops_show_the_box_and_what_is_filmed_there(scene):
    folder, _, _, before = scene
    store, entries = cut(folder, pixels=10_000, near_factor=0.95)
    views = check_store(store, entries, before)
    assert read_needs_stereo(folder / "views.json")
    for name in ("a", "b", "c"):
        view = views[name]
        places, _ = project(view, BOX.corners())
        assert (places >= -0.5).all() and (places <= np.array(view.camera.shape[::-1]) - 0.5).all()
        assert view.camera.width < 200 and 3_000 < view.camera.width * view.camera.height < 25_000
        assert store.valid_of(name).all()
        assert overlap(is_red(store.image(name)), disc_in(view)) > 0.95
    middles = {name: project(view, BOX.centre[None])[1][0] for name, view in views.items()}
    lengths = [views[name].camera.fx * BOX.longest / depth for name, depth in middles.items() if depth > 0]
    assert read_object_pixels(folder / "views.json", "a") == pytest.approx(np.median(lengths))
    for name in ("a", "c"):
        depths = project(views[name], BOX.corners())[1]
        assert entries[name].near == pytest.approx(0.95 * depths.min())
        assert 1.2 * depths.max() <= entries[name].far <= before[name].far
        assert entries[name].within == pytest.approx((depths.min(), depths.max()))


def test_a_frame_that_does_not_show_the_box_is_whole_and_keeps_its_depth_range(scene):
    folder, _, filmed, before = scene
    store, entries = cut(folder, pixels=10_000, near_factor=0.95)
    away = entries["away"]
    assert find_window(VIEWS[3], BOX.corners(), 0.05) is None
    assert away.view.camera.shape == pytest.approx((87, 116), abs=1)
    assert (away.near, away.far, away.within) == (before["away"].near, before["away"].far, None)
    mean = filmed["away"][0].mean(axis=(0, 1))
    assert store.image("away").mean(axis=(0, 1)) == pytest.approx(mean, abs=12)


@pytest.mark.parametrize("choice", ["no object", "whole"])
def test_without_a_place_or_on_demand_frames_are_whole(scene, choice):
    folder, _, _, before = scene
    store, entries = cut(folder, support=choice == "whole", whole=choice == "whole", longest_side=200)
    views = check_store(store, entries, before)
    assert {view.camera.shape for view in views.values()} == {(150, 200)}
    assert [(e.near, e.far) for e in entries.values()] == [(e.near, e.far) for e in before.values()]


def test_whole_frames_of_a_small_source_are_those_filmed(scene):
    """Exact: without distortion bit for bit; with it they are not."""
    folder, distortion, filmed, before = scene
    store, entries = cut(folder, whole=True)
    for name, view in check_store(store, entries, before).items():
        assert view.camera == scale_camera(WORKING, SOURCE, "test")
        assert np.array_equal(store.image(name), filmed[name][0]) == (distortion == (0.0, 0.0))
        assert store.valid_of(name).all()  # a lens that draws inwards shows all of the ideal frame


def test_masks_of_crops_agree_with_those_drawn_at_the_source(scene):
    """Oracle: the disc as each crop shows it, mapped back, is the disc as the lens shows it."""
    folder, distortion, filmed, _ = scene
    _, entries = cut(folder)
    whole, views = {view.name: view for view in VIEWS}, all_views(entries)
    discs = {name: disc_in(view) for name, view in views.items() if name != "away"}
    for name, mask in distort_masks(discs, views, whole, distortion, SOURCE):
        assert mask.shape == SOURCE
        assert overlap(mask, filmed[name][1]) > 0.985
        assert (mask ^ filmed[name][1]).sum() < filmed[name][1].sum() ** 0.5  # a fraction of the outline


def test_the_same_bytes_twice(scene):
    folder, *_ = scene
    cut(folder)
    first = [(folder / name).read_bytes() for name in ("crops.zarr.zip", "views.json")]
    cut(folder)
    assert first == [(folder / name).read_bytes() for name in ("crops.zarr.zip", "views.json")]


@pytest.mark.parametrize(
    "change", [{"pixels": 12_000}, {"margin": 0.1}, {"near_factor": 0.5}, {"far_factor": 2.0}, {"whole": True}]
)
def test_every_parameter_changes_what_is_written(scene, change):
    folder, *_ = scene
    cut(folder)
    first = [(folder / name).read_bytes() for name in ("crops.zarr.zip", "views.json")]
    cut(folder, **change)
    assert first != [(folder / name).read_bytes() for name in ("crops.zarr.zip", "views.json")]
