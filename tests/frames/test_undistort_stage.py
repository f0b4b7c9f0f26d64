"""Exact: the undistorted frames keep their names and figures."""

import numpy as np
import pytest

from threedfs.frames.undistort import undistort_image, valid_pixels
from threedfs.geometry.similarity import Similarity
from threedfs.io.frames import Frame, read_frames, write_frames
from threedfs.io.poses import Poses, write_poses
from threedfs.stages import undistort as stage
from threedfs.types import Camera, View

WIDE = Camera(64, 48, 60.0, 60.0, 31.5, 23.5)
LONG = Camera(64, 48, 90.0, 90.0, 31.5, 23.5)


@pytest.fixture
def run(tmp_path, job):
    def undistort(distortion):
        rng = np.random.default_rng(0)
        images = rng.integers(0, 255, (4, 48, 64, 3), dtype=np.uint8)
        frames = [Frame(f"{10 * i:06d}", 10 * i, i / 3, 0.1 * i, images[i]) for i in range(4)]
        write_frames(tmp_path / "f.zarr.zip", frames, {}, ordered=True, source_shape=(96, 128), skipped=3)
        views = tuple(View(frames[i].name, c, np.eye(4)) for i, c in ((0, WIDE), (1, WIDE), (3, LONG)))
        poses = Poses(views, ("000020",), distortion, Similarity(1.0, np.eye(3), np.zeros(3)))
        write_poses(tmp_path / "poses.json", poses, {})
        stage.run(
            frames=tmp_path / "f.zarr.zip",
            poses=tmp_path / "poses.json",
            undistorted=tmp_path / "u.zarr.zip",
            job=job,
        )
        return images, read_frames(tmp_path / "u.zarr.zip")

    return undistort


@pytest.mark.parametrize("distortion", [(0.0, 0.0), (0.3, -0.1)])
def test_all_frames_are_there_with_their_figures(run, distortion):
    images, store = run(distortion)
    assert store.names == ("000000", "000010", "000020", "000030")
    assert store.indices.tolist() == [0, 10, 20, 30]
    np.testing.assert_array_equal(store.times, np.arange(4) / 3)
    np.testing.assert_array_equal(store.sharpness, 0.1 * np.arange(4))
    assert (store.ordered, store.skipped, store.source_shape) == (True, 3, (96, 128))
    # Frame 20 has no pose: it takes the camera of frame 10, which comes before the equally near frame 30.
    for row, camera in enumerate((WIDE, WIDE, WIDE, LONG)):
        expected = undistort_image(images[row], camera, distortion)
        np.testing.assert_array_equal(store.image(store.names[row]), expected)


def test_valid_pixels_are_valid_in_every_frame(run):
    _, store = run((0.3, -0.1))
    np.testing.assert_array_equal(store.valid, valid_pixels(WIDE, (0.3, -0.1)) & valid_pixels(LONG, (0.3, -0.1)))
    assert not store.valid.all()
