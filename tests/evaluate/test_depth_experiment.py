"""Exact, property and rejection: drawing, interpolation, registration and the figures of the depth experiment."""

import numpy as np
import pytest

from threedfs.errors import UserError
from threedfs.evaluate.depth_error import DepthPairs
from threedfs.evaluate.depth_experiment import bin_errors, draw_measurements, experiment_figures, find_object_depths
from threedfs.evaluate.interpolation import interpolate_depth
from threedfs.geometry.registration import register_depth
from threedfs.types import Camera

SHAPE = (30, 40)
ROWS, COLUMNS = np.indices(SHAPE)
PLANE = 2 + 0.03 * ROWS - 0.01 * COLUMNS


def test_interpolation_of_a_plane_is_exact():
    inner = draw_measurements(PLANE[1:-1, 1:-1], 40, np.random.default_rng(0)) + 1
    pixels = np.concatenate([inner, [[0, 0], [0, 39], [29, 0], [29, 39]]])
    found = interpolate_depth(pixels, PLANE[tuple(pixels.T)], SHAPE)
    np.testing.assert_allclose(found, PLANE, rtol=1e-12)


def test_outside_the_known_pixels_the_nearest_depth_holds():
    pixels = np.array([[10, 10], [10, 20], [20, 10]])
    found = interpolate_depth(pixels, np.array([1.0, 2.0, 3.0]), SHAPE)
    assert (found[0, 0], found[10, 39], found[29, 10], found[10, 15], found[15, 10]) == (1, 2, 3, 1.5, 2)
    assert np.isfinite(found).all()


@pytest.mark.parametrize("pixels", [[[0, 0], [1, 1]], [[0, 0], [1, 1], [2, 2], [5, 5]]])
def test_interpolation_refuses_pixels_on_one_line(pixels):
    with pytest.raises(UserError, match=f"not on one line, got {len(pixels)}"):
        interpolate_depth(np.array(pixels), np.ones(len(pixels)), SHAPE)


def test_a_draw_has_each_known_pixel_at_most_once_and_starts_with_the_smaller_draw():
    truth = np.where(COLUMNS < 10, np.nan, PLANE)
    many = draw_measurements(truth, 900, np.random.default_rng(3))
    assert len(np.unique(many, axis=0)) == 900 == np.isfinite(truth).sum()
    assert np.isfinite(truth[tuple(many.T)]).all()
    np.testing.assert_array_equal(draw_measurements(truth, 100, np.random.default_rng(3)), many[:100])
    assert (draw_measurements(truth, 100, np.random.default_rng(4)) != many[:100]).any()
    with pytest.raises(UserError, match="at least 901 pixels with a true depth to draw from, got 900"):
        draw_measurements(truth, 901, np.random.default_rng(3))


def test_draws_are_uniform_over_the_image():
    drawn = np.concatenate([draw_measurements(PLANE, 200, np.random.default_rng(seed)) for seed in range(50)])
    share = np.count_nonzero(drawn[:, 1] < 20) / len(drawn)
    assert abs(share - 0.5) < 5 * np.sqrt(0.25 / len(drawn))


def test_errors_by_true_depth():
    truth = np.array([0.15, 0.2, 0.25, 0.39, 1.0])
    depth = truth + np.array([0.3, 0.0, 0.4, -0.3, 0.1])
    low, middle, high, far = bin_errors(DepthPairs(depth, truth), 0.1)
    assert (low.low, low.high, low.pixels, low.rmse) == (0.1, 0.2, 1, pytest.approx(0.3))
    assert (middle.pixels, middle.rmse) == (2, pytest.approx(np.sqrt(0.16 / 2)))
    assert (high.pixels, high.rmse) == (1, pytest.approx(0.3))
    assert (far.low, far.pixels, far.rmse) == (1.0, 1, pytest.approx(0.1))


def test_object_depths_are_those_of_the_object_without_what_shows_at_its_border():
    truth = np.where(COLUMNS < 20, 1 + 0.01 * ROWS, 5.0)
    on_object = (COLUMNS < 10) & (ROWS >= 10) & (ROWS < 20)
    on_object[10, 30] = True  # one pixel of a hundred looks past the object
    near = find_object_depths(truth, on_object)
    np.testing.assert_array_equal(near, (COLUMNS < 20) & (ROWS >= 10) & (ROWS < 20))
    assert not find_object_depths(truth, np.zeros(SHAPE, bool)).any()
    assert not find_object_depths(np.full(SHAPE, np.nan), on_object).any()


def test_figures_pool_pixels_and_name_regions_and_intervals():
    exact = DepthPairs(np.full(3, 2.0), np.full(3, 2.0))
    wrong = DepthPairs(np.array([1.05]), np.array([1.0]))
    found = experiment_figures({"a": exact, "b": wrong}, {"object_depth": wrong}, 0.5, "m")
    table = {(figure.name, figure.keyframe): figure.value for figure in found}
    assert table["depth_rmse", "a"] == 0 and table["depth_rmse", "b"] == pytest.approx(0.05)
    assert table["depth_rmse", ""] == pytest.approx(0.05 / 2)
    assert table["depth_error_mean", ""] == pytest.approx(1.25)
    assert (table["depth_within_1", ""], table["depth_within_10", ""]) == (75, 100)
    assert table["object_depth_within_1", ""] == 0 and table["object_depth_rmse", ""] == pytest.approx(0.05)
    assert table["depth_rmse_bin_1_1.5", ""] == pytest.approx(0.05) and table["depth_pixels_bin_2_2.5", ""] == 3


def test_depth_of_the_same_camera_stays_where_it_is():
    depth = np.where(COLUMNS == 7, np.nan, PLANE)
    camera = Camera(40, 30, 50.0, 52.0, 19.0, 14.0)
    np.testing.assert_array_equal(register_depth(depth, (50.0, 52.0, 19.0, 14.0), (0, 0, 0), camera), depth)


def test_depth_of_a_camera_beside_the_colour_camera_is_shifted_by_its_disparity():
    depth = np.full(SHAPE, 2.0)
    depth[10:20, 10:20] = 1.0
    camera = Camera(40, 30, 50.0, 50.0, 19.5, 14.5)
    found = register_depth(depth, (50.0, 50.0, 19.5, 14.5), (0.08, 0.0, 0.0), camera)
    # 50 * 0.08 / depth: 2 px for the wall, 4 px for the square, which hides the wall
    np.testing.assert_array_equal(found[10:20, 14:24], 1.0)
    assert np.isnan(found[10:20, 12:14]).all() and np.isnan(found[:, :2]).all()
    assert (found[:10, 2:] == 2).all() and (found[10:20, 24:] == 2).all()
    moved = register_depth(depth, (50.0, 50.0, 19.5, 14.5), (0.0, 0.0, 0.5), camera)
    assert set(np.unique(moved[np.isfinite(moved)])) == {1.5, 2.5}
