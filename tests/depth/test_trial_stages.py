"""End to end: the depth experiment on a slanted plane whose depth is known, and what it refuses."""

from __future__ import annotations

import io
import json

import cv2
import numpy as np
import pytest
import scenes
import trimesh

from threedfs.depth.bending import PRIORS
from threedfs.errors import UserError
from threedfs.geometry.projection import backproject_map
from threedfs.geometry.rigid import invert
from threedfs.geometry.similarity import Similarity
from threedfs.io.crops import Crop, write_crops
from threedfs.io.depth_maps import write_edges
from threedfs.io.depth_trials import read_depth_trial
from threedfs.io.frames import Frame, write_frames
from threedfs.io.keyframes import write_keyframes
from threedfs.io.metrics import read_metrics
from threedfs.io.poses import Poses, write_poses
from threedfs.job import Job
from threedfs.params.depth import DepthParams
from threedfs.params.depth_experiment import DepthExperimentParams
from threedfs.params.depth_trial import DepthTrialParams
from threedfs.params.schema import default_settings
from threedfs.progress import Progress
from threedfs.stages import depth_experiment, depth_trial
from threedfs.types import Keyframe

UNITS = 4.0  # of the true cameras to a scene unit
SCALE = 5000.0  # depth units to a unit of the true cameras
SETTINGS = {**default_settings(DepthParams), "candidates": 32}
SMALL = DepthTrialParams(measurements=(20, 60))


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    """What the stage reads, on disk: five views, the first a keyframe with true depth and a mask of its left half."""
    folder = tmp_path_factory.mktemp("plane")
    views = scenes.views()
    frames = (Frame(view.name, int(view.name), 0.0, 1.0, scenes.render(view)) for view in views)
    write_frames(folder / "frames.zarr.zip", frames, {}, ordered=False, source_shape=scenes.CAMERA.shape)
    crops = (Crop(view.name, scenes.render(view), np.ones(scenes.CAMERA.shape, bool)) for view in views)
    write_crops(folder / "crops.zarr.zip", crops, {}, ordered=False, source_shape=scenes.CAMERA.shape)
    scene_from_input, input_from_scene = (Similarity(scale, np.eye(3), np.zeros(3)) for scale in (1 / UNITS, UNITS))
    write_poses(folder / "poses.json", Poses(tuple(views), (), (0.0, 0.0), scene_from_input), {})
    write_keyframes(folder / "keyframes.json", [Keyframe(views[0], tuple(views[1:]), 0.6, 1.8)], {})
    write_edges(folder / "edges.zarr.zip", np.zeros(scenes.CAMERA.shape, np.float32), {})
    true_poses = [input_from_scene.apply_to_pose(view.cam_from_world) for view in views]
    entries = [
        {"name": view.name, "cam_to_world": invert(pose).tolist()} for view, pose in zip(views, true_poses, strict=True)
    ]
    camera = {"width": 96, "height": 72, "fx": 90.0, "fy": 90.0, "cx": 48.0, "cy": 36.0}
    (folder / "cameras.json").write_text(json.dumps({**camera, "frames": entries}))
    depth = scenes.plane_depth(views[0])
    for name in ("depth", "masks"):
        (folder / name).mkdir()
    cv2.imwrite(str(folder / "depth" / "0.depth.png"), np.rint(SCALE * UNITS * depth).astype(np.uint16))
    mask = np.zeros(scenes.CAMERA.shape, np.uint8)
    mask[:, :48] = 255
    cv2.imwrite(str(folder / "masks" / "0.png"), mask)
    corners = UNITS * backproject_map(views[0], depth)[[0, 0, -1, -1], [0, 47, 47, 0]]
    trimesh.Trimesh(corners, [[0, 1, 2], [0, 2, 3]]).export(folder / "mesh.ply")
    return folder


def work(scene, folder, seed=0, **changes):
    """Run the stage; return what it wrote."""
    given = {
        "frames": scene / "frames.zarr.zip",
        "crops": scene / "crops.zarr.zip",
        "keyframes": scene / "keyframes.json",
        "edges": scene / "edges.zarr.zip",
        "poses": scene / "poses.json",
        "masks_truth": scene / "masks",
        "cameras_truth": scene / "cameras.json",
        "mesh_truth": None,
        "depth_truth": scene / "depth",
        "trial": folder / "0.zarr.zip",
        "keyframe": "0",
        "depth_settings": SETTINGS,
        "depth_scale": SCALE,
        "depth_camera": None,
        "intrinsics": None,
        "params": SMALL,
        "job": Job(Progress("depth_trial", io.StringIO()), {"made": "in a test"}, seed=seed),
    }
    depth_trial.run(**{**given, **changes})
    return read_depth_trial(folder / "0.zarr.zip")


@pytest.fixture(scope="module")
def made(scene, tmp_path_factory):
    folder = tmp_path_factory.mktemp("trial")
    return folder, work(scene, folder)


def test_every_method_finds_the_plane_in_the_unit_of_the_true_cameras(made):
    trial = made[1]
    assert trial.methods == tuple(f"{how}/{n}" for n in (20, 60) for how in ("interpolation", *PRIORS))
    expected = UNITS * scenes.plane_depth(scenes.views()[0])
    np.testing.assert_allclose(trial.truth, expected, atol=1 / SCALE)
    for name, depth in zip(trial.methods, trial.depth, strict=True):
        error = np.abs(depth / expected - 1)[8:-8, 8:-8]
        # the plane's depth is nearly linear in the image; the first-order prior flattens a slant
        assert np.median(error) < (0.03 if "first_order" in name else 0.01), name
    assert len(trial.measured) == 60 and trial.on_object[:, :48].all() and not trial.on_object[:, 48:].any()


def test_the_trial_is_the_same_twice_and_another_with_another_seed(scene, made, tmp_path):
    again = work(scene, tmp_path)
    assert (tmp_path / "0.zarr.zip").read_bytes() == (made[0] / "0.zarr.zip").read_bytes()
    other = work(scene, tmp_path, seed=1)
    assert (other.measured != again.measured).any()


def test_a_true_mesh_tells_where_the_object_is_when_there_is_no_mask(scene, made, tmp_path):
    found = work(scene, tmp_path, masks_truth=None, mesh_truth=scene / "mesh.ply").on_object
    difference = found ^ made[1].on_object
    assert not difference[1:-1, 1:47].any() and not difference[:, 49:].any()  # its corners are pixel centres
    assert not work(scene, tmp_path, masks_truth=None).on_object.any()


def test_depth_images_of_a_camera_beside_the_colour_camera_are_registered(scene, made, tmp_path):
    camera = {"intrinsics": [90.0, 90.0, 47.5, 35.5], "offset": [0.0, 0.0, 0.0]}
    np.testing.assert_array_equal(work(scene, tmp_path, depth_camera=camera).truth, made[1].truth)
    camera["offset"] = [0.2, 0.0, 0.0]
    moved = work(scene, tmp_path, depth_camera=camera).truth
    assert np.isnan(moved[:, :3]).all()  # 90 * 0.2 / 4 is about 4 px
    assert np.nanmedian(np.abs(moved - made[1].truth)) > 0.02


@pytest.mark.parametrize(
    "change", [{"params": DepthTrialParams((20, 60), 0.1)}, {"depth_settings": {**SETTINGS, "smoothness": 9.0}}]
)
def test_parameters_change_the_maps_of_the_priors_and_not_the_baseline(scene, made, tmp_path, change):
    other = work(scene, tmp_path, **change)
    for name, before, after in zip(made[1].methods, made[1].depth, other.depth, strict=True):
        assert np.array_equal(before, after) == name.startswith("interpolation"), name


def test_refuses_a_keyframe_without_true_depth_or_with_too_few(scene, tmp_path):
    (tmp_path / "depth").mkdir()
    with pytest.raises(UserError, match="got 0 of which none belongs to a frame"):
        work(scene, tmp_path, depth_truth=tmp_path / "depth")
    image = np.zeros(scenes.CAMERA.shape, np.uint16)
    image[:5, :5] = 9000
    cv2.imwrite(str(tmp_path / "depth" / "0.depth.png"), image)
    with pytest.raises(UserError, match="at least 60 pixels with a true depth to draw from, got 25"):
        work(scene, tmp_path, depth_truth=tmp_path / "depth")
    cv2.imwrite(str(tmp_path / "depth" / "0.depth.png"), image[::2])
    with pytest.raises(UserError, match=r"0.depth.png: expected .* 96 x 72 pixels"):
        work(scene, tmp_path, depth_truth=tmp_path / "depth")


def score(trials, path, **params):
    names = {"dataset": "planes", "sequence": "plane"}
    job = Job(Progress("depth_experiment", io.StringIO()))
    depth_experiment.run(trials=trials, metrics=path, **names, params=DepthExperimentParams(**params), job=job)
    return read_metrics(path)


def test_scores_are_rows_of_the_tidy_table(made, tmp_path):
    folder, trial = made
    table = score([folder / "0.zarr.zip"], tmp_path / "metrics.csv", bin_width=0.5)
    assert {row.method for row in table} == {f"depth/{name}" for name in trial.methods}
    assert {(row.dataset, row.sequence) for row in table} == {("planes", "plane")}
    own = {(row.name, row.keyframe): row.value for row in table if row.method == "depth/rotation_invariant/60"}
    depth = trial.depth[trial.methods.index("rotation_invariant/60")].astype(float)
    error = depth - trial.truth
    assert own["depth_rmse", ""] == own["depth_rmse", "0"] == pytest.approx(np.sqrt((error**2).mean()), rel=1e-6)
    assert own["object_depth_rmse", ""] == pytest.approx(np.sqrt((error[:, :48] ** 2).mean()), rel=1e-6)
    relative = 100 * np.abs(error / trial.truth)
    assert own["depth_error_median", ""] == pytest.approx(np.median(relative), rel=1e-6)
    assert own["object_depth_error_median", ""] == pytest.approx(np.median(relative[:, :48]), rel=1e-6)
    low, high = np.percentile(trial.truth[:, :48], [1, 99])
    near = (trial.truth >= low) & (trial.truth <= high)
    assert own["object_range_depth_rmse", ""] == pytest.approx(np.sqrt((error[near] ** 2).mean()), rel=1e-6)
    counts = [value for (name, _), value in own.items() if name.startswith("depth_pixels_bin_")]
    assert sum(counts) == trial.truth.size
    wider = score([folder / "0.zarr.zip"], tmp_path / "metrics.csv", bin_width=100.0)
    assert [row.name for row in wider if row.name.startswith("depth_pixels")] == ["depth_pixels_bin_0_100"] * 8


def test_refuses_a_sequence_without_a_trial(tmp_path):
    with pytest.raises(UserError, match=r"expected true depth images \(truth.depth\) of keyframes, found none"):
        score(None, tmp_path / "metrics.csv")
