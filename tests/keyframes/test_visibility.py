"""Which points frames see."""

from __future__ import annotations

import numpy as np

from threedfs.keyframes.visibility import find_visibility
from threedfs.types import Camera, SparsePoints, View


def look_along_z(xyz, observations, valid=None):
    view = View("000000", Camera(40, 30, 20.0, 20.0, 20.0, 15.0), np.eye(4))
    points = SparsePoints(
        xyz=np.array(xyz, float),
        rgb=np.zeros((len(xyz), 3), np.uint8),
        error=np.zeros(len(xyz)),
        track_point=np.array(observations, np.int64),
        track_frame=np.zeros(len(observations), np.int64),
    )
    return find_visibility([view], points, np.ones((30, 40), bool) if valid is None else valid)


def test_depth_is_z_and_missing_outside_the_image():
    """Exact: a point ahead has its z, one behind the camera or beside the image has NaN."""
    visibility = look_along_z([(0, 0, 2), (0, 0, -2), (5, 0, 2)], [0])
    np.testing.assert_array_equal(visibility.depth, [[2, np.nan, np.nan]])
    np.testing.assert_array_equal(visibility.in_view, [[True, False, False]])


def test_points_on_invalid_pixels_are_not_in_view():
    """Exact: a point that falls on a border left by undistortion is not seen."""
    valid = np.ones((30, 40), bool)
    valid[15, 20] = False
    visibility = look_along_z([(0, 0, 2), (0.5, 0, 2)], [0, 1], valid)
    np.testing.assert_array_equal(visibility.seen, [[False, True]])


def test_a_frame_without_tracks_sees_what_falls_on_it():
    """Property: a frame in which nothing was triangulated still has points to judge it by."""
    np.testing.assert_array_equal(look_along_z([(0, 0, 2), (0, 0, -2)], []).seen, [[True, False]])
