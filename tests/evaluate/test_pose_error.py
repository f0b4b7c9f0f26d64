"""Exact, property and rejection: pose errors after similarity alignment."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from threedfs.errors import UserError
from threedfs.evaluate.pose_error import align_poses, measure_poses
from threedfs.geometry.rigid import camera_centres, look_at
from threedfs.geometry.similarity import Similarity

TARGET = np.array([0.3, -0.2, 0.1])


def orbit(angles, radius=2.0, height=1.0, radial=None):
    """Cameras on a circle about the vertical through TARGET, all looking at it."""
    radial = np.full(len(angles), radius) if radial is None else radial
    centres = TARGET + np.column_stack([radial * np.cos(angles), radial * np.sin(angles), np.full(len(angles), height)])
    return np.stack([look_at(centre, TARGET, np.array([0, 0, 1.0])) for centre in centres])


def test_a_similarity_leaves_no_error():
    poses = orbit(np.linspace(0, 5, 20))
    move = Similarity(3.7, Rotation.from_rotvec([0.3, -1, 0.4]).as_matrix(), np.array([5.0, -2, 8]))
    truth = np.stack([move.apply_to_pose(pose) for pose in poses])
    found = align_poses(poses, truth)
    error = measure_poses(poses, truth, found)
    assert found.scale == pytest.approx(3.7, rel=1e-12)
    assert error.centre.max() < 1e-12
    assert error.rotation.max() < 1e-7  # arccos near 1 turns rounding of 1e-16 into 1e-8 radians


def test_a_turned_camera_is_off_by_its_angle_alone():
    truth = orbit(np.linspace(0, 5, 20))
    poses = truth.copy()
    turn = np.eye(4)
    turn[:3, :3] = Rotation.from_euler("y", 2, degrees=True).as_matrix()
    poses[7] = turn @ poses[7]
    error = measure_poses(poses, truth, align_poses(poses, truth))
    assert np.rad2deg(error.rotation[7]) == pytest.approx(2, abs=1e-6)
    assert np.delete(error.rotation, 7).max() < 1e-7
    assert error.centre.max() < 1e-12


def test_centre_error_is_a_share_of_the_longest_chord():
    truth = orbit(np.linspace(0, 2 * np.pi, 8, endpoint=False))
    poses = truth.copy()
    poses[3, :3, 3] -= poses[3, :3, :3] @ [0, 0, 0.04]
    identity = Similarity(1.0, np.eye(3), np.zeros(3))
    error = measure_poses(poses, truth, identity)
    assert error.centre[3] == pytest.approx(0.04 / 4)  # the circle's diameter is 4
    assert np.count_nonzero(error.centre > 1e-12) == 1


def test_refuses_too_few_cameras_and_cameras_on_a_line():
    poses = orbit(np.linspace(0, 5, 20))
    with pytest.raises(UserError, match="at least 3 that belong to posed frames, got 2"):
        align_poses(poses[:2], poses[:2])
    line = np.tile(np.eye(4), (5, 1, 1))
    line[:, 0, 3] = range(5)
    with pytest.raises(UserError, match="do not lie on one line, got true ones"):
        align_poses(poses[:5], line)
    with pytest.raises(UserError, match="got estimated ones"):
        align_poses(np.tile(np.eye(4), (5, 1, 1)), poses[:5])


def test_centres_of_poses():
    np.testing.assert_allclose(np.linalg.norm(camera_centres(orbit([0.0, 1.0])) - TARGET, axis=1), np.sqrt(5))
