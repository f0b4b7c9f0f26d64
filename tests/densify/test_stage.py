"""Contract tests of the stage densify: our own patches and those of COLMAP's patch match become points alike."""

import cv2
import numpy as np
import pycolmap
import pytest
import scenes
from scipy.spatial import cKDTree

from threedfs.colmap.workspace import write_patch_map
from threedfs.errors import UserError
from threedfs.geometry.rigid import make_transform
from threedfs.geometry.similarity import Similarity
from threedfs.io.arrays import read_arrays
from threedfs.io.crops import Crop, write_crops
from threedfs.io.depth_maps import StereoMap, read_stereo, write_stereo
from threedfs.io.keyframes import write_keyframes
from threedfs.io.points import write_points
from threedfs.io.poses import Poses, write_poses
from threedfs.io.schema import Schema
from threedfs.io.volumes import write_support
from threedfs.job import Job
from threedfs.params.densify import DensifyParams
from threedfs.progress import Progress
from threedfs.stages import densify
from threedfs.types import Box, Keyframe, Plane, SparsePoints, Support, View

JOB = Job(Progress("test"), {"provenance": "test"})
VIEWS = scenes.views()
BETWEEN = View("between", scenes.CAMERA, make_transform(np.eye(3), [0.03, 0.02, 0.0]))
LOW, HIGH = np.array([-0.2, -0.1, 0.975]), np.array([0.2, 0.15, 1.03])
PIXEL = 1 / scenes.CAMERA.fx  # on the plane, which is about 1 away
FORM = {
    "xyz": ("float32", 2),
    "normal": ("float32", 2),
    "rgb": ("uint8", 2),
    "seen_point": ("int64", 1),
    "seen_view": ("int64", 1),
}


def write_patches(folder, view, inverse, cost):
    """Write a view's patches on the plane of an inverse depth."""
    slope = np.broadcast_to([inverse[0, 1] - inverse[0, 0], inverse[1, 0] - inverse[0, 0]], (*inverse.shape, 2))
    arrays = (inverse, slope, np.full_like(inverse, cost))
    patches = StereoMap(*(values.astype(np.float32) for values in arrays))
    write_stereo(folder / "stereo" / f"{view.name}.zarr.zip", patches, JOB.header)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """What the stage reads: the plane seen by five keyframes, their true patches, and points that all of them see.

    Of the frames that have a pose, the third is no keyframe, and sees no point.
    """
    folder = tmp_path_factory.mktemp("densify")
    posed = [*VIEWS[:2], BETWEEN, *VIEWS[2:]]
    everywhere = np.ones(scenes.CAMERA.shape, bool)
    crops = [Crop(view.name, scenes.render(view), everywhere) for view in VIEWS]
    write_crops(folder / "crops.zarr.zip", crops, JOB.header, ordered=True, source_shape=scenes.CAMERA.shape)
    write_keyframes(folder / "keyframes.json", [Keyframe(view, (), 0.4, 2.5) for view in VIEWS], JOB.header)
    still = Similarity(1.0, np.eye(3), np.zeros(3))
    write_poses(folder / "poses.json", Poses(tuple(posed), (), (0.0, 0.0), still), JOB.header)
    xyz = np.array([(x, y, 1 - 0.25 * x + 0.15 * y) for x in (-0.1, 0.0, 0.1) for y in (-0.1, 0.0, 0.1)])
    tracks = np.repeat(np.arange(9), 5), np.tile([0, 1, 3, 4, 5], 9)
    write_points(
        folder / "points.zarr.zip", SparsePoints(xyz, np.zeros((9, 3), np.uint8), np.zeros(9), *tracks), JOB.header
    )
    plane = Plane(np.array([0.0, 0.0, -1.0]), 1.5)
    write_support(
        folder / "support.json", Support(plane, Box(np.eye(3), LOW, HIGH), {"plane_noise": 0.001}), JOB.header
    )
    for view in VIEWS:
        write_patches(folder, view, 1 / scenes.plane_depth(view), 0.0)
    return folder


def find_points(folder, cuda, **changes):
    densify.run(
        crops=folder / "crops.zarr.zip",
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
    return read_arrays(folder / "cloud.zarr.zip", Schema("threedfs/oriented-points/1", "densify"))


def match_as_colmap_does(workspace, options):
    """Check what COLMAP's patch match is given, and leave maps as it would, if it erred nowhere: it needs a GPU."""
    listed = (workspace / "stereo" / "patch-match.cfg").read_text().splitlines()
    assert listed[::2] == [f"{view.name}.png" for view in VIEWS]
    model = pycolmap.Reconstruction(workspace / "sparse")
    seen = {frozenset(model.images[part.image_id].name for part in p.track.elements) for p in model.points3D.values()}
    assert len(model.points3D) == 9 and seen == {frozenset(listed[::2])}
    assert options.window_radius == 4
    normal = np.broadcast_to(-scenes.NORMAL / np.linalg.norm(scenes.NORMAL), (*scenes.CAMERA.shape, 3))
    for view in VIEWS:
        image = cv2.imread(str(workspace / "images" / f"{view.name}.png"))[..., ::-1]
        np.testing.assert_array_equal(image, scenes.render(view))
        write_patch_map(workspace, view, scenes.plane_depth(view).astype(np.float32), normal)


def test_both_engines_make_the_same_artifact(folder, monkeypatch):
    """Contract: given maps as we write them, COLMAP's path makes the points that ours does, in the same form."""
    ours, own_notes = find_points(folder, cuda=False)
    monkeypatch.setattr(pycolmap, "has_cuda", True)
    monkeypatch.setattr(pycolmap, "get_num_cuda_devices", lambda: 1, raising=False)
    monkeypatch.setattr(pycolmap, "patch_match_stereo", match_as_colmap_does, raising=False)
    theirs, notes = find_points(folder, cuda=True, window_radius=4)
    assert (own_notes.pop("engine"), notes.pop("engine")) == ("cpu", "cuda")
    assert notes == own_notes
    for arrays in (ours, theirs):
        assert {name: (values.dtype.name, values.ndim) for name, values in arrays.items()} == FORM
    assert len(theirs["xyz"]) == pytest.approx(len(ours["xyz"]), rel=0.05) and len(ours["xyz"]) > 400
    for one, other in ((ours, theirs), (theirs, ours)):
        apart, _ = cKDTree(one["xyz"]).query(other["xyz"])
        assert np.quantile(apart, 0.95) < PIXEL
    assert set(theirs["seen_view"].tolist()) == set(range(5))


def test_points_lie_on_the_surface_in_the_box(folder):
    """Exact, but for medians of pixels of five views: on the plane, towards the cameras, up to all faces of the box."""
    points, notes = find_points(folder, cuda=False)
    assert notes["views"] == [view.name for view in VIEWS]
    np.testing.assert_allclose(points["xyz"] @ scenes.NORMAL, scenes.OFFSET, atol=2e-3)
    np.testing.assert_allclose(points["normal"] @ scenes.NORMAL, -np.linalg.norm(scenes.NORMAL), atol=1e-4)
    assert (points["xyz"] >= LOW).all() and (points["xyz"] <= HIGH).all()
    assert (points["xyz"].min(axis=0) < LOW + 0.75 * PIXEL)[1:].all()  # in x the plane leaves the box by its z
    assert (points["xyz"].max(axis=0) > HIGH - 0.75 * PIXEL)[1:].all()


def test_costly_patches_make_no_points(folder):
    """Exact: of five maps that agree, the one that matches badly is in no point."""
    before = read_stereo(folder / "stereo" / "3.zarr.zip")
    try:
        write_patches(folder, VIEWS[3], 1 / scenes.plane_depth(VIEWS[3]), 0.2)
        assert 3 not in find_points(folder, cuda=False, max_cost=0.13)[0]["seen_view"]
        assert 3 in find_points(folder, cuda=False, max_cost=0.25)[0]["seen_view"]
    finally:
        write_stereo(folder / "stereo" / "3.zarr.zip", before, JOB.header)


def test_points_have_as_many_pixels_as_asked(folder):
    """Property: the more pixels a point must have, the fewer points."""
    counts = [len(find_points(folder, cuda=False, min_pixels=least)[0]["xyz"]) for least in (1, 2, 5)]
    assert counts[0] > counts[1] > counts[2] > 0


def test_without_points_the_artifact_is_empty(folder):
    points, notes = find_points(folder, cuda=False, points=False)
    assert notes["engine"] == "off"
    assert {name: (values.dtype.name, values.ndim) for name, values in points.items()} == FORM
    assert not any(map(len, points.values()))


def test_a_gpu_that_is_wanted_and_missing_is_a_sentence(folder, monkeypatch):
    """Rejection: and what was there before stays."""
    (folder / "cloud.zarr.zip").write_bytes(b"of before")
    monkeypatch.setattr(pycolmap, "has_cuda", True)
    monkeypatch.setattr(pycolmap, "get_num_cuda_devices", lambda: 0, raising=False)
    with pytest.raises(UserError, match="found no GPU"):
        find_points(folder, cuda=False, engine="cuda")
    assert (folder / "cloud.zarr.zip").read_bytes() == b"of before"
