"""Exact and property: superpixels, unaries, pairs, links, silhouettes, colours."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from scipy.ndimage import distance_transform_edt

from threedfs.errors import UserError
from threedfs.geometry.grid import cover_box, voxel_centres
from threedfs.object.silhouettes import draw_silhouette
from threedfs.segment.color_model import TableMatch, lab_from_rgb, truncate
from threedfs.segment.energy import BACKGROUND, EMPTY, OBJECT
from threedfs.segment.fit_colors import fit_color_model
from threedfs.segment.initialise import UNDECIDED, bound_object, decide_superpixels, fix_voxels, normalised_height
from threedfs.segment.outline import depth_inside, draw_voxels, grow_voxels, largest_piece, surround_voxels
from threedfs.segment.pairwise import link_voxels, superpixel_weights, voxel_pairs
from threedfs.segment.superpixels import Superpixels, split_image
from threedfs.segment.unaries import carve_unary, scene_unary, sdf_unary, silhouette_unary, soften_silhouette
from threedfs.types import Box, Camera, View

CAMERA = Camera(64, 48, 60.0, 60.0, 31.5, 23.5)


def view_from(z: float) -> View:
    """Return a view along +z from a distance in front of the origin."""
    pose = np.eye(4)
    pose[2, 3] = z
    return View("front", CAMERA, pose)


def halves() -> Superpixels:
    """Two superpixels, left and right of a boundary with known strength."""
    image = np.zeros((6, 8, 3), np.uint8)
    image[:, 4:] = 255
    strength = np.zeros((6, 8), np.float32)
    strength[:, 3:5] = 0.5
    return split_image(image, np.ones((6, 8), bool), strength, area=24.0, compactness=0.1)


def test_superpixels_are_numbered_and_know_their_boundaries():
    found = halves()
    assert found.count == 2 and found.sizes.tolist() == [24, 24]
    assert found.pairs.tolist() == [[0, 1]]
    assert found.boundary.tolist() == [12] and found.edge_sum[0] == pytest.approx(6)


def test_superpixels_leave_out_what_is_not_valid():
    rng = np.random.default_rng(0)
    image = rng.integers(0, 255, (40, 50, 3)).astype(np.uint8)
    valid = np.ones((40, 50), bool)
    valid[:, :7] = False
    found = split_image(image, valid, np.zeros((40, 50), np.float32), area=67.0, compactness=10)
    assert (found.index[~valid] == -1).all() and (found.index[valid] >= 0).all()
    assert found.sizes.sum() == valid.sum() and (found.sizes > 0).all()
    assert not found.paint(np.ones(found.count, bool))[~valid].any()
    assert found.share(valid).min() == 1


def test_pair_weights_as_printed_and_by_mean():
    found = halves()
    assert superpixel_weights(found, 2.0, pair_edge="sum")[0] == pytest.approx(np.exp(-12))
    assert superpixel_weights(found, 2.0, pair_edge="one_side")[0] == pytest.approx(np.exp(-6))
    assert superpixel_weights(found, 2.0, pair_edge="mean")[0] == pytest.approx(np.exp(-1))


def test_trimap_decides_by_nine_tenths():
    found = halves()
    left = np.zeros((6, 8), bool)
    left[:, :4] = True
    assert decide_superpixels(found, left, left, 0.9).tolist() == [OBJECT, BACKGROUND]
    assert decide_superpixels(found, np.ones((6, 8), bool), ~np.ones((6, 8), bool), 0.9).tolist() == [UNDECIDED] * 2


def test_normalised_height_is_a_half_on_the_plane_and_rises():
    height = np.linspace(-2, 2, 41, dtype=np.float32).reshape(41, 1, 1)
    normal = normalised_height(height)
    assert normal[20] == pytest.approx(0.5) and (np.diff(normal[:, 0, 0]) > 0).all()
    assert normal[-1, 0, 0] == pytest.approx(1 / (1 + np.exp(-2 / height.std())), abs=1e-6)
    fixed = fix_voxels(np.full(height.shape, 0.0, np.float32), normal, empty_level=0.9, deepest=0.3)
    assert set(np.unique(fixed)) == {BACKGROUND, UNDECIDED} and (fixed[normal < 0.3] == BACKGROUND).all()
    assert (fix_voxels(np.ones(height.shape), normal, empty_level=0.9, deepest=0.0) == EMPTY).all()


def test_over_estimate_holds_the_piece_and_the_margin():
    sdf = np.ones((30, 30, 30), np.float32)
    sdf[10:20, 10:20, 10:20] = -1
    sdf[20:24, 14:16, 14:16] = 0.3  # a lost horn
    sdf[2:4] = 0.1  # something else
    guess = sdf < 0
    outer = bound_object(sdf, guess, np.ones(sdf.shape, bool), 0.5, 0)
    assert outer[22, 15, 15] and not outer[3].any() and outer[guess].all()
    wide = bound_object(sdf, guess, np.ones(sdf.shape, bool), 0.5, 2)
    assert wide[8, 15, 15] and not wide[7, 15, 15]


def test_unaries_are_the_printed_ones():
    assert silhouette_unary(np.array([0.25])).tolist() == [[0.25, 0.75]]
    assert sdf_unary(np.array([-0.5])).tolist() == [[-0.5, -0.5, 0.5]]
    above, below = scene_unary(np.array([0.7, 0.4]))
    assert above == pytest.approx([0.7, 0, 0]) and below == pytest.approx([0, 0.6, 0.6])
    assert truncate(np.array([1.0, np.exp(-2), 0.0]), 5.0) == pytest.approx([0, 2, 5])


def test_silhouette_softens_to_both_sides():
    mask = np.zeros((1, 21), bool)
    mask[:, 11:] = True
    soft = soften_silhouette(np.repeat(mask, 5, axis=0), 4.0)[2]
    assert soft[10] + soft[11] == pytest.approx(1) and (np.diff(soft) >= 0).all()
    assert soft[5] == 0 and soft[16] == 1
    assert np.array_equal(soften_silhouette(mask, 0.0), mask)


def test_carving_by_one_mask_and_with_tolerance():
    centres = np.array([[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [50.0, 0.0, 0.0]])
    views = {"a": view_from(3.0), "b": view_from(4.0)}
    masks = {name: np.zeros(CAMERA.shape, bool) for name in views}
    for mask in masks.values():
        mask[20:28, 28:36] = True
    masks["b"][:, 36:42] = True
    valid = {name: np.ones(CAMERA.shape, bool) for name in views}
    assert carve_unary(centres, views, masks, valid, 0.0).tolist() == [0, 1, 0]
    assert carve_unary(centres, views, masks, valid, 0.5).tolist() == [0, 0, 0]
    # a pixel beyond the border of an undistorted image shows nothing, so nothing outside the mask
    valid["a"] = masks["a"]
    assert carve_unary(centres, views, masks, valid, 0.0).tolist() == [0, 0, 0]


def test_voxel_pairs_have_an_open_end_each_once():
    is_open = np.zeros((3, 3, 3), bool)
    is_open[1, 1, 1] = True
    pairs = voxel_pairs(is_open)
    assert len(pairs) == 6 and (pairs == 13).any(axis=1).all()
    assert len(voxel_pairs(np.ones((3, 4, 5), bool))) == 2 * 4 * 5 + 3 * 3 * 5 + 3 * 4 * 4


def test_links_count_shares_of_superpixels():
    found = halves()
    grid = cover_box(Box(np.eye(3), np.zeros(3), np.ones(3)), 2)
    points = np.array([[0.2, 0.2, 0.2], [0.3, 0.1, 0.2], [0.8, 0.8, 0.8], [3.0, 0.0, 0.0]])
    pairs, share = link_voxels(found, points, np.array([0, 1, 2, 3]), np.array([0, 1, 6, 7]), grid)
    assert pairs.tolist() == [[0, 0], [1, 7]]
    assert share == pytest.approx([2 / 24, 1 / 24])


def test_silhouette_of_voxels_is_that_of_the_ball_they_fill():
    grid = cover_box(Box(np.eye(3), -np.ones(3), np.ones(3)), 60)
    ball = np.linalg.norm(voxel_centres(grid), axis=-1) < 0.7
    view = view_from(4.0)
    mask = draw_voxels(ball, grid, {"front": view})["front"]
    # a ball of radius r at distance d is seen within tan(asin(r / d))
    v, u = np.mgrid[:48, :64]
    exact = np.hypot(u - CAMERA.cx, v - CAMERA.cy) <= CAMERA.fx * np.tan(np.arcsin(0.7 / 4))
    assert (mask ^ exact).sum() <= 0.03 * exact.sum()
    assert np.array_equal(mask, draw_silhouette(surround_voxels(ball, grid), view))
    assert not draw_voxels(np.zeros(grid.shape, bool), grid, {"front": view})["front"].any()


def test_largest_piece_and_growth():
    voxels = np.zeros((20, 20, 20), bool)
    voxels[2:5, 2:5, 2:5] = True
    voxels[10, 10, 10] = True
    assert largest_piece(voxels).sum() == 27
    assert grow_voxels(voxels, 1).sum() == 27 + 54 + 7
    assert grow_voxels(voxels, 0) is voxels


def colours(rng: np.random.Generator, middle: tuple[float, float, float], count: int = 2000) -> np.ndarray:
    """Draw Lab colours around one."""
    return rng.normal(middle, 3.0, (count, 3)).astype(np.float32)


def test_colours_are_told_apart_and_the_table_speaks_where_they_are_not():
    rng = np.random.default_rng(0)
    red, grey = colours(rng, (50, 40, 20)), colours(rng, (50, 0, 0))
    model = fit_color_model(red, grey, 3, None, 0)
    assert model.posterior(red).mean() > 0.99 and model.posterior(grey).mean() < 0.01
    again = fit_color_model(red, grey, 3, model, 0)
    assert again.posterior(red).mean() > 0.99
    same = fit_color_model(grey, colours(rng, (50, 0, 0)), 3, None, 0)
    yes = np.ones(2000, bool)
    table = TableMatch(np.ones(2000, bool), grey, np.full(2000, -3 * np.log(3.0) - 2.76, np.float32), yes)
    assert same.posterior(grey, table).mean() < same.posterior(grey).mean()
    other = TableMatch(np.ones(2000, bool), grey, np.full(2000, -60.0, np.float32), yes)
    assert same.posterior(grey, other).mean() > 0.9
    unknown = TableMatch(np.zeros(2000, bool), grey, np.full(2000, -60.0, np.float32), yes)
    assert np.array_equal(same.posterior(grey, unknown), same.posterior(grey))


def test_a_region_without_pixels_is_refused():
    with pytest.raises(UserError, match="pixels of the object"):
        fit_color_model(np.zeros((3, 3), np.float32), np.zeros((50, 3), np.float32), 10, None, 0)


def test_lab_of_white_and_black():
    assert lab_from_rgb(np.array([[255, 255, 255], [0, 0, 0]], np.uint8)) == pytest.approx(
        np.array([[100, 0, 0], [0, 0, 0]]), abs=0.1
    )


@pytest.mark.parametrize("threads", [1, 2])
def test_distances_from_an_outline_are_exact_on_any_number_of_threads(threads):
    """Oracle: scipy's; with one thread OpenCV's faster ones were off in the last bits, and not the same twice."""
    rows, columns = np.mgrid[:240, :320]
    mask = (rows - 120) ** 2 + (columns - 150) ** 2 < 60**2
    own, other = (distance_transform_edt(part).astype(np.float32) for part in (mask, ~mask))
    before = cv2.getNumThreads()
    cv2.setNumThreads(threads)
    try:
        found = depth_inside(mask)
    finally:
        cv2.setNumThreads(before)
    np.testing.assert_array_equal(found, np.where(mask, own - np.float32(0.5), np.float32(0.5) - other))
