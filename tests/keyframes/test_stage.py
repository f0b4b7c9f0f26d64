"""The stage on artifacts of a ring of cameras: what comes out can be read and holds what was asked for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from threedfs.errors import UserError
from threedfs.geometry.rigid import look_at
from threedfs.geometry.similarity import Similarity
from threedfs.io.frames import Frame, write_frames
from threedfs.io.images import write_mask
from threedfs.io.keyframes import read_keyframes
from threedfs.io.points import write_points
from threedfs.io.poses import Poses, write_poses
from threedfs.job import Job
from threedfs.params.keyframes import KeyframesParams
from threedfs.progress import Progress
from threedfs.stages import keyframes as stage


@pytest.fixture
def run_stage(make_ring, tmp_path):
    """Write the inputs of a ring of 72 frames and run the stage on them; `moved` gives some another pose."""
    ring = make_ring(count=72)
    inputs = {name: tmp_path / file for name, file in (("poses", "p.json"), ("points", "p.zip"), ("frames", "f.zip"))}
    blank = np.zeros((120, 160, 3), np.uint8)
    frames = [Frame(view.name, int(view.name), 0.0, 1.0, blank) for view in ring.views]
    write_points(inputs["points"], ring.points, {})
    same = Similarity(1.0, np.eye(3), np.zeros(3))

    def run(masks=None, name="out.json", ordered=True, moved=None, **changes):
        poses = {i: view.cam_from_world for i, view in enumerate(ring.views)} | (moved or {})
        views = tuple(replace(view, cam_from_world=poses[i]) for i, view in enumerate(ring.views))
        write_frames(inputs["frames"], frames, {}, ordered=ordered, source_shape=(120, 160))
        write_poses(inputs["poses"], Poses(views, (), (0.0, 0.0), same), {})
        job = Job(Progress("keyframes"), header={"made_by": "a test"})
        out = tmp_path / name
        stage.run(**inputs, masks=masks, keyframes=out, params=KeyframesParams(**changes), job=job)
        return out

    return run


def test_keyframes_are_written_in_order(run_stage):
    """Property: the number asked for, in the order of the frames, each with neighbours and a depth range."""
    entries = read_keyframes(run_stage(max_keyframes=8, max_gap=180.0))
    assert len(entries) == 8 and list(entries) == sorted(entries)
    for name, entry in entries.items():
        assert entry.view.name == name
        assert len(entry.neighbours) == 10 and name not in [view.name for view in entry.neighbours]
        # Points lie within 0.1 of the centre, cameras 1.08 away.
        assert 0.55 * 0.97 < entry.near < 0.55 * 1.1 and 1.2 * 1.06 < entry.far < 1.2 * 1.19


@pytest.mark.parametrize(("least", "count"), [(1.0, 18), (0.25, 24)])
def test_sectors_are_shortened_to_reach_the_number_asked_for(run_stage, least, count):
    """Exact: 72 frames make 18 sectors by the score, and 24 shorter ones."""
    assert len(read_keyframes(run_stage(max_keyframes=24, least_score_share=least))) == count


def test_a_higher_score_has_fewer_sectors(run_stage):
    """Property: it is not lowered unless that is asked for."""
    assert len(read_keyframes(run_stage(max_keyframes=24, new_keyframe_score=4.0, max_gap=180.0))) < 18


def test_enough_annotated_frames_are_the_only_keyframes(run_stage, tmp_path):
    """Exact: no sector is made for what is not needed."""
    for number in (30, 350):
        write_mask(tmp_path / "masks" / f"{number}.png", np.zeros((4, 4), bool))
    given = {"masks": tmp_path / "masks", "max_keyframes": 2, "max_gap": 180.0}
    assert list(read_keyframes(run_stage(**given, least_score_share=0.01))) == ["000030", "000350"]


def test_annotated_frames_are_keyframes(run_stage, tmp_path):
    """Exact: masks are found by frame number whatever the zeros, and count."""
    for number in (30, 350):
        write_mask(tmp_path / "masks" / f"{number}.png", np.zeros((4, 4), bool))
    entries = read_keyframes(run_stage(masks=tmp_path / "masks", max_keyframes=8, max_gap=180.0))
    assert {"000030", "000350"} <= set(entries) and len(entries) == 8


def test_the_same_bytes_twice(run_stage):
    """Exact: two runs, one content."""
    assert run_stage(name="a.json").read_bytes() == run_stage(name="b.json").read_bytes()


def test_masks_of_no_frame_are_refused(run_stage, tmp_path):
    """Rejection: masks whose names fit no frame."""
    write_mask(tmp_path / "masks" / "cover.png", np.zeros((4, 4), bool))
    with pytest.raises(UserError, match="expected masks named after frames"):
        run_stage(masks=tmp_path / "masks")


AWAY = look_at(np.array([1.0, -0.4, 0.0]), np.array([5.0, -0.4, 0.0]), np.array([0, -1.0, 0]))
"""A pose from which no point is in view."""


@pytest.mark.parametrize("ordered", [True, False])
def test_frames_that_see_no_points_are_left_out_with_a_note(run_stage, capsys, ordered):
    """Property: a video, or photos, go on without them."""
    entries = read_keyframes(run_stage(ordered=ordered, moved={5: AWAY, 40: AWAY}, max_keyframes=18))
    assert len(entries) >= 12 and not {"000050", "000400"} & set(entries)
    assert "too few sparse points in view: 000050, 000400" in capsys.readouterr().err


def test_an_annotated_frame_that_sees_no_points_is_refused(run_stage, tmp_path):
    """Rejection: it must be a keyframe and cannot."""
    write_mask(tmp_path / "masks" / "50.png", np.zeros((4, 4), bool))
    with pytest.raises(UserError, match="keyframe 000050: expected at least 10 sparse points in view, got 0"):
        run_stage(masks=tmp_path / "masks", moved={5: AWAY})


def test_a_camera_that_stands_still_is_refused(run_stage, make_ring):
    """Rejection: no keyframe has a neighbour."""
    still = make_ring(count=72).views[0].cam_from_world
    with pytest.raises(UserError, match="No frame sees its points from another place"):
        run_stage(moved=dict.fromkeys(range(72), still))


def test_keyframes_without_neighbours_are_left_out_unless_annotated(run_stage, tmp_path, monkeypatch, capsys):
    """Property: one keyframe without a neighbour costs that keyframe, or is refused by its name."""
    found = stage.choose_neighbours
    monkeypatch.setattr(stage, "choose_neighbours", lambda v, f, rule: [] if f == 3 else found(v, f, rule))
    assert "000030" not in read_keyframes(run_stage(max_keyframes=72, new_keyframe_score=1e-6))
    assert "no frame sees from another place: 000030" in capsys.readouterr().err
    write_mask(tmp_path / "masks" / "30.png", np.zeros((4, 4), bool))
    with pytest.raises(UserError, match="keyframe 000030: expected frames that see its points from another place"):
        run_stage(masks=tmp_path / "masks")
