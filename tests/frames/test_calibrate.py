"""Oracle, exact, rejection: a lens is recovered from drawn boards; real boards fit as OpenCV's documentation says."""

from functools import cache, lru_cache
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

from threedfs.errors import UserError
from threedfs.frames.calibrate import calibrate, find_board
from threedfs.geometry.distortion import distort, undistort
from threedfs.io.calibration import Calibration, read_calibration, write_calibration
from threedfs.params.calibrate import CalibrateParams
from threedfs.stages import calibrate as stage
from threedfs.types import Camera

CAMERA = Camera(480, 360, 430.0, 426.0, 244.0, 176.0)
LENS = (-0.2, 0.08)
BOARD = (7, 5)
REAL_BOARDS = Path(__file__).parents[3] / "shared" / "data" / "checkerboard"


def poses(count):
    """Rotations and positions from which the whole board is in view."""
    rng = np.random.default_rng(1)
    for _ in range(count):
        rotation = cv2.Rodrigues(rng.uniform(-0.45, 0.45, 3))[0]
        shift = np.array([rng.uniform(-1, 1), rng.uniform(-0.7, 0.7), rng.uniform(9, 11)])
        yield rotation, shift


def image_corners(rotation, shift):
    """Where the corners of the board, centred on its own origin, are imaged: (35, 2) pixels."""
    rows, columns = np.mgrid[: BOARD[1], : BOARD[0]]
    board = np.stack([columns - 3.0, rows - 2.0, 0.0 * rows], axis=-1).reshape(-1, 3)
    seen = board @ rotation.T + shift
    return distort(seen[:, :2] / seen[:, 2:], LENS) * (CAMERA.fx, CAMERA.fy) + (CAMERA.cx, CAMERA.cy)


@lru_cache(maxsize=1)
def cast_rays(fine):
    """Directions of fine x fine rays a pixel through the lens, (360 fine, 480 fine, 3)."""
    v, u = (np.mgrid[: CAMERA.height * fine, : CAMERA.width * fine] + 0.5) / fine - 0.5
    points = np.stack([(u - CAMERA.cx) / CAMERA.fx, (v - CAMERA.cy) / CAMERA.fy], axis=-1)
    return np.concatenate([undistort(points, LENS), np.ones((*u.shape, 1))], axis=-1)


@cache
def draw_boards(count, fine=3):
    """Draw the board in each pose as the lens images it: (360, 480, 3) uint8 images."""
    images = []
    for rotation, shift in poses(count):
        # The board's plane is z = 0 in its own axes: scale rays there.
        eye, along = -shift @ rotation, cast_rays(fine) @ rotation
        x, y = (eye[axis] - along[..., axis] * eye[2] / along[..., 2] for axis in (0, 1))
        squares = (np.floor(x + 4) + np.floor(y + 3)) % 2 * 200 + 30
        grey = np.where((np.abs(x) < 4) & (np.abs(y) < 3), squares, 230)
        grey = grey.reshape(CAMERA.height, fine, CAMERA.width, fine).mean(axis=(1, 3))
        images.append(np.repeat(np.rint(grey).astype(np.uint8)[..., None], 3, axis=-1))
    return tuple(images)


def test_exact_corners_give_the_exact_lens():
    corners = [image_corners(*pose) for pose in poses(8)]
    result = calibrate(corners, BOARD, CAMERA.shape)
    # Corners pass through float32, 3e-5 pixels at these positions; a lens amplifies that about a hundredfold.
    found = result.camera
    np.testing.assert_allclose(
        [found.fx, found.fy, found.cx, found.cy], [CAMERA.fx, CAMERA.fy, CAMERA.cx, CAMERA.cy], atol=0.01
    )
    np.testing.assert_allclose([result.k1, result.k2], LENS, atol=1e-3)
    assert result.rms < 1e-3
    assert (result.boards, found.width, found.height) == (8, 480, 360)


def test_the_same_corners_give_the_same_lens_to_the_bit():
    # OpenCV's own threads make repeated fits differ in the ninth digit.
    noise = np.random.default_rng(2).normal(0, 0.1, (20, 35, 2))
    corners = [image_corners(*pose) + noise[index] for index, pose in enumerate(poses(20))]
    assert len({calibrate(corners, BOARD, CAMERA.shape) for _ in range(6)}) == 1


def test_corners_are_found_where_they_are_drawn():
    pose = next(poses(6))
    found = find_board(draw_boards(6)[0], BOARD, 5)
    expected = image_corners(*pose)
    distance = np.linalg.norm(found[:, None] - expected, axis=-1).min(axis=1)
    assert distance.max() < 0.15  # what sub-pixel refinement reaches on an image of 3x3 samples a pixel


def test_no_board_is_none(drawn):
    assert find_board(drawn.draw(0), BOARD, 5) is None


@pytest.fixture
def photographed(tmp_path):
    folder = tmp_path / "boards"
    folder.mkdir()
    for index, image in enumerate(draw_boards(6)):
        Image.fromarray(image).save(folder / f"{index}.png")
    return folder


def run(boards, path, job, **settings):
    stage.run(boards=boards, calibration=path, params=CalibrateParams(**settings), job=job)
    return read_calibration(path)


def test_stage_recovers_the_lens_from_photos(tmp_path, photographed, job):
    result = run(photographed, tmp_path / "c.json", job, board_columns=7, board_rows=5)
    assert result.boards == 6 and result.rms < 0.15
    # Six boards with corners good to about 0.05 pixel.
    np.testing.assert_allclose([result.camera.fx, result.camera.fy], [CAMERA.fx, CAMERA.fy], rtol=0.01)
    np.testing.assert_allclose([result.camera.cx, result.camera.cy], [CAMERA.cx, CAMERA.cy], atol=3)
    edge = np.array([0.5, 0.3])
    np.testing.assert_allclose(distort(edge, (result.k1, result.k2)), distort(edge, LENS), atol=2 / CAMERA.fx)


def test_stage_takes_a_video(tmp_path, make_video, job):
    video = make_video(tmp_path / "v.mp4", count=6, draw=lambda index: draw_boards(6)[index])
    result = run(video, tmp_path / "c.json", job, board_columns=7, board_rows=5)
    assert result.boards == 6
    np.testing.assert_allclose(result.camera.fx, CAMERA.fx, rtol=0.02)


def test_a_board_that_is_not_found_is_refused(tmp_path, photographed, job):
    with pytest.raises(UserError, match=r"board of 9x6 inner corners .* found it in 0"):
        run(photographed, tmp_path / "c.json", job)
    assert not (tmp_path / "c.json").exists()


def test_a_poor_fit_is_refused(tmp_path, photographed, job):
    with pytest.raises(UserError, match=r"boards: expected corners that fit a camera to 0\.001 pixels"):
        run(photographed, tmp_path / "c.json", job, board_columns=7, board_rows=5, max_rms=0.001)


def test_round_trip_of_the_file(tmp_path):
    calibration = Calibration(CAMERA, -0.1, 0.02, 0.15, 12)
    write_calibration(tmp_path / "c.json", calibration, {"parameters": {}})
    assert read_calibration(tmp_path / "c.json") == calibration


@pytest.mark.skipif(not REAL_BOARDS.is_dir(), reason="shared/data/checkerboard is not here")
def test_real_boards(tmp_path, job):
    result = run(REAL_BOARDS, tmp_path / "c.json", job)
    # OpenCV's full model (tangential terms and k3) gives rms 0.153, f 518.6, centre (315.6, 249.3) on these photos.
    assert result.boards == 25
    assert result.rms < 0.16
    assert result.camera.fx == pytest.approx(518.6, rel=0.005)
    assert result.camera.cx == pytest.approx(315.6, abs=5)
    assert result.camera.cy == pytest.approx(249.3, abs=3)
