"""Oracle: the size of a pattern whose corners are projected exactly, or drawn into pictures."""

from __future__ import annotations

import io
from functools import cache

import cv2
import numpy as np
import pytest

from threedfs.errors import UserError
from threedfs.geometry.lens import Lens
from threedfs.geometry.rigid import look_at
from threedfs.geometry.similarity import Similarity
from threedfs.io.frames import Frame, write_frames
from threedfs.io.meshes import write_mesh
from threedfs.io.poses import Poses, write_poses
from threedfs.io.scales import read_scale, tell_scale
from threedfs.io.volumes import write_support
from threedfs.job import Job
from threedfs.params.scale import ScaleParams
from threedfs.progress import Progress
from threedfs.scale.board import align_boards, board_places
from threedfs.scale.measure import Measurement, choose_tag, measure_pattern
from threedfs.scale.tags import CORNERS, find_tags
from threedfs.stages.scale import run
from threedfs.types import Box, Camera, Mesh, Plane, Support, View

LENS = Lens(Camera(480, 360, 500.0, 500.0, 239.5, 179.5), -0.12, 0.03)
UNIT = 0.137  # metres in a scene unit
SIDE = 0.06  # metres
GAMMA = 2.2
TURN = np.array([[np.cos(0.4), -np.sin(0.4)], [np.sin(0.4), np.cos(0.4)]])


def walk(frames, turns=0.8):
    """Return poses around the origin, scene units."""
    angles = np.linspace(0, 2 * np.pi * turns, frames, endpoint=False)
    places = [2.4 * np.array([np.cos(a), np.sin(a), 0.8 + 0.2 * np.sin(3 * a)]) for a in angles]
    up = np.array([0.0, 0.0, 1.0])
    return {f"{index:06d}": look_at(place, np.zeros(3), up) for index, place in enumerate(places)}


def lay(places, unit=UNIT):
    """Put a pattern, metres and y down, flat on the table, scene units; seen from above it is not mirrored."""
    centred = (places - places.mean(axis=0)) * [1, -1]
    return np.column_stack([centred @ TURN.T / unit, np.zeros(len(places))])


def see(points, pose):
    """Project points of the scene as the lens does."""
    inside = points @ pose[:3, :3].T + pose[:3, 3]
    return LENS.denormalise(inside[:, :2] / inside[:, 2:])


@cache
def make_rays(side=3):
    """Return the rays (R, C, 3) float32 of a camera with so many times the pixels a side."""
    v, u = (np.mgrid[: 360 * side, : 480 * side] + 0.5) / side - 0.5
    ideal = LENS.normalise(np.stack([u, v], axis=-1))
    return np.concatenate([ideal, np.ones((*u.shape, 1))], axis=-1).astype(np.float32)


def photograph(page, corners, pose):
    """Photograph a page of linear light (R, C) whose four corners lie at `corners`, metres, on a grey table."""
    ideal = make_rays()
    directions = ideal @ pose[:3, :3].astype(np.float32)
    centre = -pose[:3, :3].T @ pose[:3, 3]
    ground = centre[:2] - centre[2] * directions[..., :2] / directions[..., 2:]
    to_page = cv2.getPerspectiveTransform(
        lay(corners)[:, :2].astype(np.float32),
        np.array([[0, 0], [page.shape[1], 0], [*page.shape[::-1]], [0, page.shape[0]]], np.float32),
    )
    places = cv2.perspectiveTransform(ground.reshape(-1, 1, 2), to_page).reshape(*ideal.shape[:2], 2) - 0.5
    light = cv2.remap(
        page.astype(np.float32),
        places[..., 0].astype(np.float32),
        places[..., 1].astype(np.float32),
        cv2.INTER_LINEAR,
        borderMode=cv2.BORDER_CONSTANT,
        borderValue=0.3,
    )
    light = cv2.GaussianBlur(cv2.resize(light, (480, 360), interpolation=cv2.INTER_AREA), (0, 0), 0.6)
    noise = np.random.default_rng(int(1000 * abs(pose[0, 3]))).normal(0, 1.5, light.shape)
    grey = np.clip(255 * light ** (1 / GAMMA) + noise, 0, 255)
    return np.repeat(np.rint(grey).astype(np.uint8)[..., None], 3, axis=2)


def draw_tag(dictionary, number=3):
    """Return a tag with a white margin as wide as half of it, and the page's corners in sides of the tag."""
    tag = cv2.aruco.generateImageMarker(cv2.aruco.getPredefinedDictionary(dictionary), number, 240)
    page = np.full((480, 480), 0.8)
    page[120:360, 120:360] = np.where(tag > 0, 0.8, 0.02)
    return page, np.array([[-0.5, -0.5], [1.5, -0.5], [1.5, 1.5], [-0.5, 1.5]])


def draw_board(board):
    """Return a checkerboard with a white margin of a square, and the page's corners in squares."""
    across, down = board[0] + 1, board[1] + 1
    squares = np.kron(np.add.outer(np.arange(down), np.arange(across)) % 2, np.ones((40, 40)))
    page = np.pad(np.where(squares > 0, 0.8, 0.02), 40, constant_values=0.8)
    return page, np.array([[-2.0, -2], [board[0] + 1, -2], [board[0] + 1, board[1] + 1], [-2, board[1] + 1]])


@pytest.fixture
def scene(tmp_path):
    """Return a function that writes the frames and poses of a walk around a page."""

    def make(page, corners, frames=8):
        poses = walk(frames)
        pictures = [photograph(page, corners, pose) for pose in poses.values()]
        taken = [Frame(name, i, i / 10, 1.0, pictures[i]) for i, name in enumerate(poses)]
        write_frames(tmp_path / "frames.zarr.zip", taken, {}, ordered=True, source_shape=(360, 480))
        views = tuple(View(name, LENS.camera, pose) for name, pose in poses.items())
        found = Poses(views, (), (LENS.k1, LENS.k2), Similarity(1.0, np.eye(3), np.zeros(3)))
        write_poses(tmp_path / "poses.json", found, {})
        return tmp_path

    return make


def find(folder, known, **params):
    """Run the stage on a scene."""
    place = {"frames": folder / "frames.zarr.zip", "poses": folder / "poses.json", "mesh": None, "support": None}
    job = Job(Progress("scale", io.StringIO()))
    run(**place, scale=folder / "scale.json", known=known, params=ScaleParams(**params), job=job)
    return read_scale(folder / "scale.json")


@pytest.mark.parametrize("places", [SIDE * CORNERS, 0.02 * board_places((5, 4))])
def test_exact_corners_give_the_exact_scale(places):
    """Exact: through the lens and back, to rounding."""
    poses = walk(6)
    seen = {name: see(lay(places), pose) for name, pose in poses.items()}
    found = measure_pattern(seen, places, dict.fromkeys(poses, LENS), poses)
    assert found.scale == pytest.approx(UNIT, rel=1e-9)
    assert found.spread < 1e-9 and found.frames == 6


def test_a_few_wrong_frames_do_no_harm():
    poses = walk(12)
    seen = {name: see(lay(SIDE * CORNERS), pose) for name, pose in poses.items()}
    for name in list(seen)[:3]:
        seen[name] = seen[name] + [25.0, -14.0]
    found = measure_pattern(seen, SIDE * CORNERS, dict.fromkeys(poses, LENS), poses)
    assert found.scale == pytest.approx(UNIT, rel=2e-3)


def test_one_view_tells_nothing():
    poses = walk(1)
    seen = {name: see(lay(SIDE * CORNERS), pose) for name, pose in poses.items()}
    assert measure_pattern(seen, SIDE * CORNERS, dict.fromkeys(poses, LENS), poses) is None


@pytest.mark.parametrize("board", [(5, 4), (4, 4)])
def test_boards_get_one_order_wherever_the_detector_starts(board):
    places, poses = 0.02 * board_places(board), walk(8)
    straight = {name: see(lay(places), pose) for name, pose in poses.items()}
    turns = (0, 1, 2, 3) if board[0] == board[1] else (0, 2)
    turned = {
        name: np.rot90(pixels.reshape(board[1], board[0], 2), turns[i % len(turns)]).reshape(-1, 2)
        for i, (name, pixels) in enumerate(straight.items())
    }
    aligned = align_boards(turned, board, dict.fromkeys(poses, LENS), poses)
    order = next(
        turn
        for turn in range(4)
        if np.allclose(
            np.rot90(straight["000000"].reshape(board[1], board[0], 2), turn).reshape(-1, 2), aligned["000000"]
        )
    )
    for name, pixels in aligned.items():
        expected = np.rot90(straight[name].reshape(board[1], board[0], 2), order).reshape(-1, 2)
        np.testing.assert_allclose(pixels, expected)


@pytest.mark.parametrize(
    ("dictionary", "name"),
    [
        (cv2.aruco.DICT_4X4_50, "4x4 3"),
        (cv2.aruco.DICT_7X7_250, "7x7 3"),
        (cv2.aruco.DICT_APRILTAG_36h11, "april_36h11 3"),
    ],
)
def test_a_tag_in_pictures_gives_the_scale(scene, dictionary, name):
    """Through blur, noise and the lens, with the working resolution's few pixels."""
    page, corners = draw_tag(dictionary)
    found = find(scene(page, SIDE * corners), {"source": "tag", "length": SIDE})
    assert found.metres_per_unit == pytest.approx(UNIT, rel=0.005)
    assert found.uncertainty < 0.01 and found.frames == 8 and found.detail == name
    assert "tag of 60 mm" in tell_scale(found)


def test_a_board_in_pictures_gives_the_scale(scene):
    page, corners = draw_board((6, 4))
    found = find(scene(page, 0.012 * corners), {"source": "board", "length": 0.012, "corners": [6, 4]})
    assert found.metres_per_unit == pytest.approx(UNIT, rel=0.005)
    assert found.uncertainty < 0.01 and found.frames == 8


def test_a_scene_without_a_tag_is_refused(scene):
    page, corners = draw_board((6, 4))
    folder = scene(page, 0.012 * corners, frames=4)
    with pytest.raises(UserError, match=r"marker of 60 mm in at least 3 frames.*found none.*white margin"):
        find(folder, {"source": "tag", "length": SIDE})
    assert not (folder / "scale.json").exists()


def test_too_few_frames_and_too_wide_a_spread_are_refused(scene):
    page, corners = draw_tag(cv2.aruco.DICT_4X4_50)
    folder = scene(page, SIDE * corners, frames=4)
    with pytest.raises(UserError, match=r"in at least 5 frames.*found 4x4 3 in 4 with"):
        find(folder, {"source": "tag", "length": SIDE}, min_frames=5)
    with pytest.raises(UserError, match=r"distances that disagree by 0\.\d %"):
        find(folder, {"source": "tag", "length": SIDE}, max_spread=1e-6)


def test_a_board_counted_wrongly_is_refused(scene):
    page, corners = draw_board((6, 4))
    with pytest.raises(UserError, match=r"checkerboard of 7x5 inner corners.*count the corners between"):
        find(scene(page, 0.012 * corners, frames=4), {"source": "board", "length": 0.012, "corners": [7, 5]})


def test_two_tags_of_different_sizes_are_refused(scene):
    small, corners = draw_tag(cv2.aruco.DICT_4X4_50, 5)
    page = np.full((480, 800), 0.8)
    page[:, :480] = draw_tag(cv2.aruco.DICT_4X4_50, 3)[0]
    page[160:400, 520:760] = cv2.resize(small, (240, 240), interpolation=cv2.INTER_AREA)
    corners = np.array([[-0.5, -0.5], [17 / 6, -0.5], [17 / 6, 1.5], [-0.5, 1.5]])
    with pytest.raises(UserError, match=r"tags of one size, found 4x4 . and 4x4 ., whose sides are as 1 to"):
        find(scene(page, SIDE * corners), {"source": "tag", "length": SIDE})


def test_what_looks_like_a_tag_by_chance_is_not_chosen():
    measured = {"a": Measurement(1, 0.002, 20), "b": Measurement(2, 0.2, 30), "c": Measurement(3, 0.001, 4)}
    assert choose_tag(measured, 3, 0.03) == ["a"]


def test_the_same_tag_twice_in_a_picture_is_left_out():
    page, _ = draw_tag(cv2.aruco.DICT_4X4_50)
    grey = np.repeat((255 * page[..., None]).astype(np.uint8), 3, axis=2)
    assert [*find_tags(grey, 5)] == ["4x4 3"]
    assert find_tags(np.hstack([grey, grey]), 5) == {}


def test_a_given_height_is_that_of_the_mesh(tmp_path):
    """Exact: along the plane's normal, whatever way that points."""
    normal = np.array([0.6, 0.0, 0.8])
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], *(2.5 * normal)[None]])
    write_mesh(tmp_path / "mesh.ply", Mesh(corners, np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])))
    plane = Plane(normal, 0.0)
    write_support(tmp_path / "support.json", Support(plane, Box(np.eye(3), -np.ones(3), np.ones(3)), {}), {})
    known = {"source": "height", "length": 0.05, "method": "surface"}
    place = {"frames": None, "poses": None, "mesh": tmp_path / "mesh.ply", "support": tmp_path / "support.json"}
    job = Job(Progress("scale", io.StringIO()))
    run(**place, scale=tmp_path / "scale.json", known=known, params=ScaleParams(), job=job)
    found = read_scale(tmp_path / "scale.json")
    assert found.metres_per_unit == pytest.approx(0.02, rel=1e-6)
    assert found.uncertainty is None and tell_scale(found) == "given height of 50 mm"
