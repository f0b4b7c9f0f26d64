"""The stage on artifacts of a ring of cameras: what comes out can be read and holds what was asked for."""

from __future__ import annotations

import numpy as np
import pytest

from threedfs.errors import UserError
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
    """Write the inputs of a ring of 72 frames and run the stage on them."""
    ring = make_ring(count=72)
    inputs = {
        name: tmp_path / file for name, file in (("poses", "p.json"), ("points", "p.zip"), ("undistorted", "f.zip"))
    }
    blank = np.zeros((120, 160, 3), np.uint8)
    frames = (Frame(view.name, int(view.name), 0.0, 1.0, blank) for view in ring.views)
    write_frames(inputs["undistorted"], frames, {}, ordered=True, source_shape=(120, 160))
    write_points(inputs["points"], ring.points, {})
    same = Similarity(1.0, np.eye(3), np.zeros(3))
    write_poses(inputs["poses"], Poses(ring.views, (), (0.0, 0.0), same), {})

    def run(masks=None, name="out.json", **changes):
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
