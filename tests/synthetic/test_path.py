"""Property tests of the handheld path."""

import numpy as np
import pytest

from threedfs.checks import check_transform
from threedfs.synthetic.path import HandheldPath

STEADY = {"shake_position": 0.0, "shake_rotation": 0.0, "wander": 0.0}


def centres(path, times):
    poses = [path.cam_from_world(t) for t in times]
    return np.array([-pose[:3, :3].T @ pose[:3, 3] for pose in poses])


def test_a_steady_hand_looks_at_the_target_and_keeps_its_bounds():
    path = HandheldPath(8.0, distance=(0.5, 0.7), elevation=(20, 50), target=(0.1, 0, 0.1), **STEADY)
    times = np.linspace(0, 8, 100)
    for time in times:
        in_camera = check_transform(path.cam_from_world(time), "pose") @ [0.1, 0, 0.1, 1]
        assert np.hypot(*in_camera[:2]) < 1e-12
        assert 0.5 - 1e-9 <= in_camera[2] <= 0.7 + 1e-9
    offset = centres(path, times) - [0.1, 0, 0.1]
    elevation = np.degrees(np.arcsin(offset[:, 2] / np.linalg.norm(offset, axis=1)))
    assert 20 - 1e-9 <= elevation.min() < 23 and 47 < elevation.max() <= 50 + 1e-9


@pytest.mark.parametrize("turns", [0.75, -1.0])
def test_an_even_pace_makes_the_wanted_turns(turns):
    path = HandheldPath(8.0, turns=turns, unevenness=0.0, **STEADY)
    centre = centres(path, np.linspace(0, 8, 200))
    azimuth = np.unwrap(np.arctan2(centre[:, 1], centre[:, 0]))
    assert azimuth[-1] - azimuth[0] == pytest.approx(2 * np.pi * turns)


def test_shake_has_the_stated_size():
    still = HandheldPath(8.0, **STEADY)
    shaky = HandheldPath(8.0, **(STEADY | {"shake_position": 0.002}))
    times = np.linspace(0, 200, 1001)
    tremor = centres(shaky, times) - centres(still, times)
    assert np.sqrt((tremor**2).mean()) == pytest.approx(0.002, rel=0.1)  # 24 sines, 160 periods and more


def test_the_path_is_smooth_and_seeded():
    path = HandheldPath(8.0, seed=5)
    centre = centres(path, np.arange(0, 8, 1 / 30))
    step = np.linalg.norm(np.diff(centre, axis=0), axis=1)
    assert step.max() / np.median(step) < 3
    assert np.array_equal(path.cam_from_world(1.0), HandheldPath(8.0, seed=5).cam_from_world(1.0))
    assert not np.allclose(path.cam_from_world(1.0), HandheldPath(8.0, seed=6).cam_from_world(1.0))
