"""Contract tests of the stages stereo and stereo_check on a slanted plane seen by five cameras."""

import numpy as np
import pytest
import scenes

from threedfs.errors import UserError
from threedfs.io.crops import Crop, write_crops
from threedfs.io.depth_maps import Semidense, read_stereo, write_semidense, write_stereo
from threedfs.io.keyframes import write_keyframes
from threedfs.io.volumes import write_support
from threedfs.job import Job
from threedfs.params.stereo import StereoParams
from threedfs.params.stereo_check import StereoCheckParams
from threedfs.progress import Progress
from threedfs.stages import stereo, stereo_check
from threedfs.stereo.region import mask_box
from threedfs.types import Box, Keyframe, Plane, Support

JOB = Job(Progress("test"), {"provenance": "test"})


@pytest.fixture(scope="module")
def matched(tmp_path_factory):
    """A folder with the stereo maps of all five views, and their keyframes."""
    folder = tmp_path_factory.mktemp("stereo")
    views = scenes.views()
    everywhere = np.ones(scenes.CAMERA.shape, bool)
    crops = [Crop(view.name, scenes.render(view), everywhere) for view in views]
    write_crops(folder / "crops.zarr.zip", crops, JOB.header, ordered=True, source_shape=scenes.CAMERA.shape)
    entries = [Keyframe(view, tuple(other for other in views if other is not view), 0.4, 2.5) for view in views]
    write_keyframes(folder / "keyframes.json", entries, JOB.header)
    nothing = np.full(scenes.CAMERA.shape, np.nan, np.float32)
    write_semidense(folder / "semidense.zarr.zip", Semidense(nothing, nothing), JOB.header)
    for view in views:
        stereo.run(
            crops=folder / "crops.zarr.zip",
            keyframes=folder / "keyframes.json",
            semidense=folder / "semidense.zarr.zip",
            support=None,
            stereo=folder / "stereo" / f"{view.name}.zarr.zip",
            keyframe=view.name,
            params=StereoParams(levels=2, views=4),
            job=JOB,
        )
    return folder


def check(folder, **changes):
    stereo_check.run(
        keyframes=folder / "keyframes.json",
        stereo=sorted((folder / "stereo").iterdir()),
        checked=folder / "checked.zarr.zip",
        keyframe="0",
        params=StereoCheckParams(**changes),
        job=JOB,
    )
    return read_stereo(folder / "checked.zarr.zip")


def test_confirmed_matches_are_kept_and_true(matched):
    """Exact: what the other views confirm lies on the plane."""
    kept = check(matched, min_agreeing=2)
    known = np.isfinite(kept.inverse_depth)
    truth = 1 / scenes.plane_depth(scenes.views()[0])
    assert known.mean() > 0.6
    assert np.quantile(np.abs(kept.inverse_depth / truth - 1)[known], 0.95) < 0.02


def test_a_match_that_no_other_view_confirms_is_dropped(matched):
    """Property: a map at a wrong depth, however good its cost, loses all its pixels."""
    path = matched / "stereo" / "0.zarr.zip"
    own = read_stereo(path)
    try:
        write_stereo(path, type(own)(own.inverse_depth * 1.2, own.slope, own.cost), JOB.header)
        assert np.isfinite(check(matched).inverse_depth).mean() < 0.02
        assert np.isfinite(check(matched, min_agreeing=0).inverse_depth).mean() > 0.6
    finally:
        write_stereo(path, own, JOB.header)


def test_costly_matches_are_dropped(matched):
    """Exact: no pixel above the cost is kept."""
    kept = check(matched, max_cost=0.01)
    assert (kept.cost[np.isfinite(kept.inverse_depth)] <= 0.01).all()


@pytest.mark.parametrize("side", [0.15, 0.25])
def test_around_a_place_only_its_pixels_are_matched(matched, side):
    """Exact: the box says where there are patches, and where none."""
    low, high = np.array([-side, -0.1, 0.9]), np.array([side, 0.15, 1.1])
    plane = Plane(np.array([0.0, 0.0, -1.0]), 1.5)
    write_support(
        matched / "support.json", Support(plane, Box(np.eye(3), low, high), {"plane_noise": 0.001}), JOB.header
    )
    stereo.run(
        crops=matched / "crops.zarr.zip",
        keyframes=matched / "keyframes.json",
        semidense=matched / "semidense.zarr.zip",
        support=matched / "support.json",
        stereo=matched / "around.zarr.zip",
        keyframe="0",
        params=StereoParams(levels=2, views=4),
        job=JOB,
    )
    found = np.isfinite(read_stereo(matched / "around.zarr.zip").inverse_depth)
    wanted = mask_box(scenes.views()[0], Box(np.eye(3), low, high))
    assert 0.1 < wanted.mean() < 0.9
    assert not found[~wanted].any() and found[wanted].mean() > 0.8


def test_more_deciding_views_than_views_are_refused():
    """Rejection: three views cannot decide among two."""
    with pytest.raises(UserError, match="best_views <= views"):
        StereoParams(views=2, best_views=3)
