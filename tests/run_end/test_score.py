"""Exact, oracle and rejection: results of any program scored against a truth."""

from __future__ import annotations

import json

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from threedfs.cli.main import main
from threedfs.errors import UserError
from threedfs.io.images import write_mask
from threedfs.io.meshes import write_mesh
from threedfs.io.metrics import read_metrics
from threedfs.run_end.score import score_cameras, score_masks, score_mesh
from threedfs.types import Mesh


def values(figures):
    """The figures of the whole sequence, by name."""
    return {figure.name: figure.value for figure in figures if not figure.keyframe}


def square(start, size=20):
    mask = np.zeros((size, size), bool)
    mask[start : start + 10, 5:15] = True
    return mask


@pytest.fixture
def ball(tmp_path):
    """Path of a ball of radius 1, and the mesh."""
    made = trimesh.creation.icosphere(subdivisions=4)
    mesh = Mesh(np.asarray(made.vertices), np.asarray(made.faces))
    write_mesh(tmp_path / "ball.ply", mesh)
    return tmp_path / "ball.ply", mesh


def write_cameras(path, turn=None, shift=(0, 0, 0), scale=1.0, count=8, name="{:06d}"):
    """Cameras on a spiral, in a world that is turned, scaled and shifted."""
    rotation = np.eye(3) if turn is None else turn
    entries = []
    for number in range(count):
        angle = 0.6 * number
        pose = np.eye(4)
        pose[:3, :3] = rotation @ Rotation.from_euler("y", angle).as_matrix()
        pose[:3, 3] = scale * rotation @ [4 * np.cos(angle), 0.2 * number, 4 * np.sin(angle)] + shift
        entries.append({"file_path": f"images/{name.format(number)}.png", "transform_matrix": pose.tolist()})
    lens = {"w": 64, "h": 48, "fl_x": 50.0, "fl_y": 50.0, "cx": 32.0, "cy": 24.0}
    path.write_text(json.dumps({**lens, "frames": entries}))
    return path


@pytest.mark.parametrize("end", [".png", ".png.png", ".mask.png"])
def test_masks_of_any_convention_are_found_by_the_frame(tmp_path, end):
    for name, start in (("000000", 5), ("000010", 10), ("000020", 0)):
        write_mask(tmp_path / f"true/{name}.png", square(5))
        if name != "000020":
            write_mask(tmp_path / f"mine/{name}{end}", square(start))
    found = score_masks(tmp_path / "mine", tmp_path / "true")
    assert values(found) == {
        "iou_mean": pytest.approx((1 + 1 / 3) / 2),
        "iou_median": pytest.approx((1 + 1 / 3) / 2),
        "iou_min": pytest.approx(1 / 3),
        "masks_scored": 2,
        "masks_unmatched": 1,
    }
    assert {figure.keyframe for figure in found} == {"", "000000", "000010"}


def test_numbers_of_frames_are_names(tmp_path):
    """Exact: 5.png and 000005.png are of one frame; both in one folder are refused."""
    write_mask(tmp_path / "mine/5.png", square(5))
    write_mask(tmp_path / "true/000005.png", square(5))
    assert values(score_masks(tmp_path / "mine", tmp_path / "true"))["iou_mean"] == 1
    write_mask(tmp_path / "mine/05.png", square(5))
    with pytest.raises(UserError, match=r"one mask of each frame, found 05.png of the same"):
        score_masks(tmp_path / "mine", tmp_path / "true")


def test_masks_that_cannot_be_compared_are_refused(tmp_path):
    write_mask(tmp_path / "mine/a.png", square(5))
    write_mask(tmp_path / "other/b.png", square(5))
    write_mask(tmp_path / "small/a.png", square(5, 16))
    write_mask(tmp_path / "black/a.png", np.zeros((20, 20), bool))
    for folder, sentence in (
        ("other", "expected masks named like those of"),
        ("small", "expected a mask of 20 x 20 pixels"),
        ("black", "expected a white object on black in at least one mask, got 1 that are black all over"),
        ("absent", "expected a folder of masks"),
    ):
        with pytest.raises(UserError, match=sentence):
            score_masks(tmp_path / "mine", tmp_path / folder)


def test_a_mesh_is_without_error_against_itself_and_has_that_of_its_growth(ball, tmp_path):
    path, mesh = ball
    same = values(score_mesh(path, path))
    assert same["mesh_f_score_0.25"] > 0.999 and same["mesh_closed"] == 1 and same["mesh_genus"] == 0
    write_mesh(tmp_path / "large.ply", Mesh(1.02 * mesh.vertices, mesh.faces))
    grown = values(score_mesh(tmp_path / "large.ply", path))
    diagonal = np.linalg.norm([2, 2, 2])
    assert grown["mesh_accuracy"] == pytest.approx(100 * 0.02 / diagonal, rel=0.05)
    assert grown["mesh_f_score_0.5"] == 0 and grown["mesh_f_score_1"] > 0.999


def test_cameras_move_a_mesh_to_the_true_one(ball, tmp_path):
    path, mesh = ball
    turn = Rotation.from_euler("xyz", [0.3, -1.0, 2.0]).as_matrix()
    write_mesh(tmp_path / "moved.ply", Mesh(3 * mesh.vertices @ turn.T + [90, 5, 1], mesh.faces))
    mine = write_cameras(tmp_path / "mine.json", turn, (90, 5, 1), 3.0)
    true = write_cameras(tmp_path / "transforms.json")
    with pytest.raises(UserError, match="give --cameras and --true-cameras"):
        score_mesh(tmp_path / "moved.ply", path)
    with pytest.raises(UserError, match="got those of one"):
        score_mesh(tmp_path / "moved.ply", path, mine)
    assert values(score_mesh(tmp_path / "moved.ply", path, mine, true))["mesh_f_score_0.25"] > 0.999
    errors = values(score_cameras(mine, true))
    assert errors["pose_centre_error_max"] < 1e-6 and errors["pose_rotation_error_max"] < 1e-4


def test_cameras_are_paired_by_the_names_of_their_frames(tmp_path):
    mine = write_cameras(tmp_path / "mine.json")
    short = write_cameras(tmp_path / "short.json", name="{}")
    assert values(score_cameras(mine, short))["pose_centre_error_max"] < 1e-6
    others = write_cameras(tmp_path / "others.json", name="left_{}")
    with pytest.raises(UserError, match=r"named like those of .*mine.json, such as 000000, found 0; .*like left_0"):
        score_cameras(mine, others)
    document = json.loads(mine.read_text())
    document["frames"] += json.loads(short.read_text())["frames"]
    both = tmp_path / "both.json"
    both.write_text(json.dumps(document))
    with pytest.raises(UserError, match=r"both.json: expected one camera of each frame, found several of 000000"):
        score_cameras(both, mine)


def test_the_command_prints_and_writes_the_figures(ball, tmp_path, capsys):
    path = str(ball[0])
    assert main(["score", "--mesh", path, "--true-mesh", path, "--csv", str(tmp_path / "scores.csv")]) == 0
    assert "mesh_f_score_0.5             1" in capsys.readouterr().out
    assert {row.name: row.value for row in read_metrics(tmp_path / "scores.csv")}["mesh_f_score_0.5"] > 0.999


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ([], "expected --masks, --mesh or --cameras"),
        (["--mesh", "a.ply"], "expected --mesh and --true-mesh together"),
        (["--mesh", "lost.ply", "--true-mesh", "lost.ply"], "lost.ply: expected a mesh"),
        (["--cameras", "lost.json", "--true-cameras", "lost.json"], "expected given cameras"),
    ],
)
def test_the_command_refuses_in_one_sentence(words, sentence, capsys):
    assert main(["score", *words]) == 1
    assert sentence in capsys.readouterr().err
