"""Contract tests of the stage densify: our own patches and those of COLMAP's patch match become points alike."""

import numpy as np
import pycolmap
import pytest
import scenes
from scipy.spatial import cKDTree

from threedfs.colmap.workspace import write_patch_map
from threedfs.errors import UserError
from threedfs.geometry.similarity import Similarity
from threedfs.io.arrays import read_arrays
from threedfs.io.depth_maps import StereoMap, write_stereo
from threedfs.io.frames import Frame, write_frames
from threedfs.io.keyframes import write_keyframes
from threedfs.io.oriented_points import ORIENTED_POINTS
from threedfs.io.points import write_points
from threedfs.io.poses import Poses, write_poses
from threedfs.io.volumes import Support, write_support
from threedfs.job import Job
from threedfs.params.densify import DensifyParams
from threedfs.progress import Progress
from threedfs.stages import densify
from threedfs.types import Keyframe, Plane, SparsePoints

JOB = Job(Progress("test"), {"provenance": "test"})
VIEWS = scenes.views()
LOW, HIGH = np.array([-0.2, -0.1, 0.8]), np.array([0.2, 0.15, 1.2])


def plane_slope(view):
    """Change of the plane's inverse depth per pixel, the same everywhere."""
    inverse = 1 / scenes.plane_depth(view)
    return np.broadcast_to([inverse[0, 1] - inverse[0, 0], inverse[1, 0] - inverse[0, 0]], (*scenes.CAMERA.shape, 2))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """What the stage reads: the plane seen by five views, its true patches, and points that all of them see."""
    folder = tmp_path_factory.mktemp("densify")
    frames = [Frame(view.name, rank, 0.0, 1.0, scenes.render(view)) for rank, view in enumerate(VIEWS)]
    write_frames(folder / "frames.zarr.zip", frames, JOB.header, ordered=True, source_shape=scenes.CAMERA.shape)
    write_keyframes(folder / "keyframes.json", [Keyframe(view, (), 0.4, 2.5) for view in VIEWS], JOB.header)
    still = Similarity(1.0, np.eye(3), np.zeros(3))
    write_poses(folder / "poses.json", Poses(tuple(VIEWS), (), (0.0, 0.0), still), JOB.header)
    xyz = np.array([(x, y, 1 - 0.25 * x + 0.15 * y) for x in (-0.1, 0.0, 0.1) for y in (-0.1, 0.0, 0.1)])
    tracks = np.repeat(np.arange(9), 5), np.tile(np.arange(5), 9)
    write_points(
        folder / "points.zarr.zip", SparsePoints(xyz, np.zeros((9, 3), np.uint8), np.zeros(9), *tracks), JOB.header
    )
    plane = Plane(np.array([0.0, 0.0, -1.0]), 1.5)
    write_support(folder / "support.json", Support(plane, LOW, HIGH, {"plane_noise": 0.001}), JOB.header)
    for view in VIEWS:
        inverse = (1 / scenes.plane_depth(view)).astype(np.float32)
        patches = StereoMap(inverse, plane_slope(view).astype(np.float32), np.zeros_like(inverse))
        write_stereo(folder / "stereo" / f"{view.name}.zarr.zip", patches, JOB.header)
    return folder


def find_points(folder, cuda, **changes):
    densify.run(
        undistorted=folder / "frames.zarr.zip",
        keyframes=folder / "keyframes.json",
        poses=folder / "poses.json",
        points=folder / "points.zarr.zip",
        support=folder / "support.json",
        stereo=None if cuda else sorted((folder / "stereo").iterdir()),
        cloud=folder / "cloud.zarr.zip",
        cuda=cuda,
        params=DensifyParams(**changes),
        job=JOB,
    )
    return read_arrays(folder / "cloud.zarr.zip", ORIENTED_POINTS)


def match_as_colmap_does(workspace, options):
    """Leave in a workspace what COLMAP's patch match would, if it erred nowhere: it needs a GPU."""
    listed = (workspace / "stereo" / "patch-match.cfg").read_text().splitlines()
    assert listed[::2] == [f"{view.name}.png" for view in VIEWS]
    assert len(pycolmap.Reconstruction(workspace / "sparse").points3D) == 9
    assert options.window_radius == 4
    normal = np.broadcast_to(-scenes.NORMAL / np.linalg.norm(scenes.NORMAL), (*scenes.CAMERA.shape, 3))
    for view in VIEWS:
        write_patch_map(workspace, view, scenes.plane_depth(view).astype(np.float32), normal)


def test_both_engines_make_the_same_artifact(folder, monkeypatch):
    """Contract: of the same patches COLMAP's path makes the points that ours does, in the same form."""
    ours, own_notes = find_points(folder, cuda=False)
    monkeypatch.setattr(pycolmap, "has_cuda", True)
    monkeypatch.setattr(pycolmap, "get_num_cuda_devices", lambda: 1, raising=False)
    monkeypatch.setattr(pycolmap, "patch_match_stereo", match_as_colmap_does, raising=False)
    theirs, notes = find_points(folder, cuda=True, window_radius=4)
    assert (own_notes.pop("engine"), notes.pop("engine")) == ("cpu", "cuda")
    assert notes == own_notes
    assert {name: values.dtype for name, values in ours.items()} == {name: theirs[name].dtype for name in theirs}
    assert len(theirs["xyz"]) == pytest.approx(len(ours["xyz"]), rel=0.05) and len(ours["xyz"]) > 500
    apart, _ = cKDTree(ours["xyz"]).query(theirs["xyz"])
    assert np.quantile(apart, 0.95) < 0.01  # a pixel is 0.011 wide there
    assert set(theirs["seen_view"].tolist()) == set(range(5))


def test_points_lie_on_the_surface_in_the_box(folder):
    """Exact, but for medians of pixels of five views: on the plane, towards the cameras, none beyond the box."""
    points, notes = find_points(folder, cuda=False)
    assert notes["views"] == [view.name for view in VIEWS]
    np.testing.assert_allclose(points["xyz"] @ scenes.NORMAL, scenes.OFFSET, atol=2e-3)
    np.testing.assert_allclose(points["normal"] @ scenes.NORMAL, -np.linalg.norm(scenes.NORMAL), atol=1e-4)
    assert (points["xyz"] >= LOW).all() and (points["xyz"] <= HIGH).all()
    reach = np.ptp(points["xyz"][:, :2], axis=0)
    assert (reach > 0.9 * (HIGH - LOW)[:2]).all()


def test_without_points_the_artifact_is_empty(folder):
    points, notes = find_points(folder, cuda=False, points=False)
    assert notes["engine"] == "off" and len(points["xyz"]) == 0


def test_a_gpu_that_is_wanted_and_missing_is_a_sentence(folder, monkeypatch):
    """Rejection: and what was there before stays."""
    before = (folder / "cloud.zarr.zip").read_bytes() if (folder / "cloud.zarr.zip").exists() else None
    monkeypatch.setattr(pycolmap, "has_cuda", True)
    monkeypatch.setattr(pycolmap, "get_num_cuda_devices", lambda: 0, raising=False)
    with pytest.raises(UserError, match="found no GPU"):
        find_points(folder, cuda=False, engine="cuda")
    assert before == ((folder / "cloud.zarr.zip").read_bytes() if (folder / "cloud.zarr.zip").exists() else None)
