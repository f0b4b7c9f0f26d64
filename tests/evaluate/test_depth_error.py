"""Exact and rejection: depth of shapes whose depth is known, and its error figures."""

import cv2
import numpy as np
import pytest
import trimesh

from threedfs.errors import UserError
from threedfs.evaluate.depth_error import DepthPairs, measure_depth, pair_depths, pool_pairs
from threedfs.evaluate.rendering import MeshRenderer, filmed_pixels, image_points, sample_nearest
from threedfs.geometry.distortion import distort
from threedfs.io.truth import read_depth_image
from threedfs.io.truth_files import find_depth_images
from threedfs.types import Camera, Mesh

CAMERA = Camera(64, 48, 60.0, 62.0, 31.2, 23.7)
STILL = np.eye(4)


def as_mesh(made):
    return Mesh(np.asarray(made.vertices, np.float64), np.asarray(made.faces, np.int64))


def test_depth_of_a_tilted_plane():
    x, y = np.array([-12.0, 12, 12, -12]), np.array([-12.0, -12, 12, 12])
    mesh = Mesh(np.column_stack([x, y, 12 + 0.5 * x + 0.25 * y]), np.array([[0, 1, 2], [0, 2, 3]]))
    points = image_points(CAMERA, (0.0, 0.0))
    expected = 12 / (1 - 0.5 * points[..., 0] - 0.25 * points[..., 1])
    np.testing.assert_allclose(MeshRenderer(mesh).depth(STILL, points), expected, rtol=1e-12)


def test_depth_of_a_cube_is_that_of_its_front_and_nothing_beside_it():
    mesh = as_mesh(
        trimesh.creation.box(extents=(1, 1, 1), transform=trimesh.transformations.translation_matrix((0, 0, 4)))
    )
    points = image_points(CAMERA, (0.0, 0.0))
    depth = MeshRenderer(mesh).depth(STILL, points)
    np.testing.assert_array_equal(np.isfinite(depth), np.abs(points).max(-1) < 0.5 / 3.5)
    np.testing.assert_allclose(depth[np.isfinite(depth)], 3.5, rtol=1e-12)


def test_a_mesh_around_the_camera_is_seen_everywhere():
    mesh = as_mesh(trimesh.creation.box(extents=(2, 2, 2)))
    depth = MeshRenderer(mesh).depth(STILL, image_points(CAMERA, (0.0, 0.0)))
    np.testing.assert_allclose(depth, 1, rtol=1e-12)


def test_image_points_undo_the_lens():
    lens = (0.2, -0.05)
    points = image_points(CAMERA, lens)
    seen = distort(points, lens) * (CAMERA.fx, CAMERA.fy) + (CAMERA.cx, CAMERA.cy)
    np.testing.assert_allclose(seen[10, 20], [20, 10], atol=1e-9)


def test_filmed_pixels_scale_about_pixel_corners():
    pixels = filmed_pixels(CAMERA, CAMERA, (0.0, 0.0), (96, 128))
    np.testing.assert_allclose(pixels[0, 0], [0.5, 0.5], atol=1e-12)
    np.testing.assert_allclose(pixels[-1, -1], [126.5, 94.5], atol=1e-12)


def test_two_calibrations_meet_at_the_same_spot_of_the_sensor():
    lens = (0.1, 0.02)
    pixels = filmed_pixels(CAMERA, CAMERA, lens, CAMERA.shape)
    ideal = np.stack(np.meshgrid(np.arange(64), np.arange(48)), axis=-1)
    points = image_points(CAMERA, lens, pixels)
    np.testing.assert_allclose(points * (CAMERA.fx, CAMERA.fy) + (CAMERA.cx, CAMERA.cy), ideal, atol=1e-9)


def test_sampling_takes_the_nearest_pixel_and_tells_what_is_outside():
    image = np.arange(6.0).reshape(2, 3)
    pixels = np.array([[0.4, 0.4], [1.6, 0.6], [2.4, 1.4], [2.6, 0], [-0.6, 0], [np.nan, 0]])
    np.testing.assert_array_equal(sample_nearest(image, pixels, np.nan), [0, 5, 5, np.nan, np.nan, np.nan])


def test_figures_of_known_errors():
    truth = np.full(100, 2.0)
    depth = truth * np.r_[np.full(50, 1.005), np.full(30, 0.95), np.full(20, 1.5)]
    error = measure_depth(DepthPairs(depth, truth))
    assert error.median == pytest.approx((0.005 + 0.05) / 2)
    assert error.mean == pytest.approx(0.5 * 0.005 + 0.3 * 0.05 + 0.2 * 0.5)
    assert (error.within_1, error.within_10, error.covered) == (0.5, 0.8, 1)
    assert error.rmse == pytest.approx(2 * np.sqrt(0.5 * 0.005**2 + 0.3 * 0.05**2 + 0.2 * 0.5**2))


def test_missing_depths_count_against_the_shares_only():
    error = measure_depth(DepthPairs(np.full(60, 2.0), np.full(60, 2.0), missing=40))
    assert (error.mean, error.within_1, error.within_10, error.covered) == (0, 0.6, 0.6, 0.6)
    assert measure_depth(DepthPairs(np.zeros(0), np.zeros(0), missing=3)) is None


def test_pairs_leave_out_the_border_and_what_is_unknown():
    truth = np.full((20, 20), np.nan)
    truth[4:16, 4:16] = 2
    depth = np.full((20, 20), 3.0)
    depth[10, 10] = np.nan
    pairs = pair_depths(depth, truth, erosion=2)
    assert (len(pairs.depth), pairs.missing) == (8 * 8 - 1, 1)
    assert len(pair_depths(depth, truth).depth) == 12 * 12 - 1
    assert pool_pairs([pairs, pairs]).missing == 2


def test_depth_images_are_of_the_scale_given(tmp_path):
    image = np.array([[0, 1500], [65535, 2]], np.uint16)
    cv2.imwrite(str(tmp_path / "frame-000008.depth.png"), image)
    files = find_depth_images(tmp_path, ["frame-000000.color", "frame-000008.color"])
    assert list(files) == ["frame-000008.color"]
    np.testing.assert_array_equal(
        read_depth_image(files["frame-000008.color"], 1000.0), [[np.nan, 1.5], [np.nan, 0.002]]
    )
    np.testing.assert_array_equal(
        read_depth_image(files["frame-000008.color"], 500.0), [[np.nan, 3.0], [np.nan, 0.004]]
    )


def test_refuses_depth_images_that_are_none(tmp_path):
    with pytest.raises(UserError, match="none belongs to a frame"):
        find_depth_images(tmp_path, ["000010"])
    cv2.imwrite(str(tmp_path / "a.depth.png"), np.zeros((2, 2, 3), np.uint8))
    with pytest.raises(UserError, match="one channel of 16-bit depths, got uint8"):
        read_depth_image(tmp_path / "a.depth.png", 1000.0)
    (tmp_path / "b.depth.png").write_text("no image")
    with pytest.raises(UserError, match="none that can be decoded"):
        read_depth_image(tmp_path / "b.depth.png", 1000.0)
