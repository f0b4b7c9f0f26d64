"""Exact tests of where a box is seen."""

import numpy as np
import scenes

from threedfs.geometry.projection import backproject_map
from threedfs.stereo.region import mask_box
from threedfs.types import Box, View


def meets_box(view: View, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Slabs: a ray meets a box if it is between all three pairs of sides at once, in front of the camera."""
    centre = -view.cam_from_world[:3, :3].T @ view.cam_from_world[:3, 3]
    rays = backproject_map(view, np.ones(view.camera.shape)) - centre
    with np.errstate(divide="ignore"):
        ways = np.stack([(low - centre) / rays, (high - centre) / rays])
    return np.maximum(ways.min(axis=0).max(axis=-1), 0) <= ways.max(axis=0).min(axis=-1)


def test_pixels_whose_rays_meet_the_box():
    """Oracle: the same pixels as by cutting each ray with the slabs of the box."""
    low, high = np.array([-0.1117, -0.0713, 0.8]), np.array([0.1313, 0.1017, 1.15])
    for view in scenes.views():
        expected = meets_box(view, low, high)
        assert 0.05 < expected.mean() < 0.5
        np.testing.assert_array_equal(mask_box(view, Box(np.eye(3), low, high)), expected)


def test_a_box_around_the_camera_is_seen_everywhere():
    """Property: nothing is left out where the outline is not known."""
    assert mask_box(scenes.views()[0], Box(np.eye(3), np.full(3, -1.0), np.ones(3))).all()
