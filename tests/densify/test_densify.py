"""Exact tests of normals of patches, of tracks and of the crop to the object."""

import numpy as np

from threedfs.densify.crop import crop_points
from threedfs.densify.normals import patch_normals
from threedfs.densify.tracks import list_tracks
from threedfs.types import Box, Camera, OrientedPoints, Plane, SparsePoints

CAMERA = Camera(64, 48, 60.0, 62.0, 30.0, 25.0)

UNIT = Box(np.eye(3), np.zeros(3), np.ones(3))


def test_normals_are_those_of_the_plane_whose_inverse_depth_it_is():
    """Exact: n x = e seen by a pinhole camera has inverse depth n ray / e, affine in the pixel."""
    plane, offset = np.array([0.3, -0.2, -0.933]), -1.5
    plane /= np.linalg.norm(plane)
    v, u = np.mgrid[:48, :64]
    inverse = (plane[0] * (u - 30) / 60 + plane[1] * (v - 25) / 62 + plane[2]) / offset
    slope = np.broadcast_to(np.array([plane[0] / 60, plane[1] / 62]) / offset, (48, 64, 2))
    np.testing.assert_allclose(patch_normals(CAMERA, inverse, slope), np.broadcast_to(plane, (48, 64, 3)), atol=1e-12)


def test_normals_face_the_camera_and_are_missing_where_the_patch_is():
    inverse = np.full((48, 64), 0.5)
    inverse[0, 0] = np.nan
    normal = patch_normals(CAMERA, inverse, np.zeros((48, 64, 2)))
    assert np.isnan(normal[0, 0]).all()
    assert (normal[..., 2].ravel()[1:] < 0).all()


def test_tracks_are_the_points_that_two_of_the_frames_see():
    points = SparsePoints(
        np.arange(9.0).reshape(3, 3),
        np.zeros((3, 3), np.uint8),
        np.zeros(3),
        np.array([0, 0, 1, 1, 2, 2]),
        np.array([4, 7, 4, 5, 9, 7]),
    )
    tracks = list_tracks(points, [7, 4, 9])
    assert [(point.tolist(), ranks) for point, ranks in tracks] == [([0, 1, 2], [0, 1]), ([6, 7, 8], [0, 2])]


def test_crop_keeps_what_stands_on_the_plane_inside_the_box_with_its_sightings():
    xyz = np.array([(0, 0, 0.5), (0, 0, 0.001), (2, 0, 0.5), (0.5, 0.5, 0.9)], np.float32)
    points = OrientedPoints(xyz, xyz, np.zeros((4, 3), np.uint8), np.array([0, 0, 1, 3, 3]), np.array([1, 2, 1, 0, 5]))
    cropped = crop_points(points, UNIT, Plane(np.array([0.0, 0, 1]), 0.0), 0.01, min_sightings=2)
    np.testing.assert_array_equal(cropped.xyz, xyz[[0, 3]])
    assert cropped.seen_point.tolist() == [0, 0, 1, 1]
    assert cropped.seen_view.tolist() == [1, 2, 0, 5]


def test_crop_leaves_out_points_of_few_sightings():
    xyz = np.full((2, 3), 0.5, np.float32)
    points = OrientedPoints(xyz, xyz, np.zeros((2, 3), np.uint8), np.array([0, 0, 1, 1, 1]), np.array([1, 2, 0, 3, 5]))
    cropped = crop_points(points, UNIT, Plane(np.array([0.0, 0, 1]), 0.0), 0.01, min_sightings=3)
    assert cropped.seen_point.tolist() == [0, 0, 0]
    assert cropped.seen_view.tolist() == [0, 3, 5]
