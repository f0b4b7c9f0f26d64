"""Geometry and search of one pixel."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from threedfs.geometry.projection import backproject, project
from threedfs.params.semidense import SemidenseParams
from threedfs.semidense.epipolar import (
    FOUND,
    NOT_SEARCHED,
    WORK,
    SearchRule,
    _compare,
    search_line,
)
from threedfs.semidense.epipolar_segment import TEMPLATE_MARGIN
from threedfs.semidense.gradient import find_textured, image_gradient, to_grey
from threedfs.semidense.pair import relate

PARAMS = SemidenseParams()
RULE = SearchRule(*(getattr(PARAMS, name) for name in SearchRule._fields))
BOUNDS = (0.4, 2.5)


def search(scene, u, v, low=BOUNDS[0], high=BOUNDS[1], neighbour=0, grey=None, other=None, other_valid=None, rule=RULE):
    view, image, _ = scene.neighbours[neighbour]
    grey = to_grey(scene.image) if grey is None else grey
    other = to_grey(image) if other is None else other
    other_valid = np.ones(other.shape, bool) if other_valid is None else other_valid
    pair = relate(scene.keyframe.view, view)
    other = np.where(other_valid, other, np.float32(np.nan))
    work = np.empty((2, WORK))
    return search_line(grey, *image_gradient(grey), other, u, v, low, high, BOUNDS, pair, rule, work)


def search_many(scene, **given):
    """Search a grid of pixels of the keyframe; return outcomes, found inverse depths, variances and the truth."""
    rows, columns = np.mgrid[20:160:4, 20:220:4].reshape(2, -1)
    results = [search(scene, u, v, **given) for u, v in zip(columns, rows, strict=True)]
    outcome, found, variance = (np.array(part) for part in zip(*results, strict=True))
    return outcome, found, variance, 1 / scene.depth[rows, columns]


def test_differences_are_those_of_windows():
    """Oracle: each window less its mean against the template; windows with an unknown sample count as infinite."""
    rng = np.random.default_rng(0)
    samples, template = rng.uniform(0, 255, 40), rng.uniform(-90, 90, 5)
    samples[17] = np.nan
    template -= template.mean()
    windows = np.lib.stride_tricks.sliding_window_view(samples, 5)
    expected = ((windows - windows.mean(axis=1, keepdims=True) - template) ** 2).sum(axis=1)
    found = np.empty(36)
    seen, best = _compare(samples, tuple(template), found)
    np.testing.assert_allclose(found, np.where(np.isnan(expected), np.inf, expected), rtol=1e-9)
    assert seen == 31 and best == np.nanargmin(expected)


def test_pair_geometry_agrees_with_projection(make_scene):
    """Oracle: transfer by homography and baseline equals back-projection and projection, cameras differing."""
    scene = make_scene(neighbour_focal=260.0)
    key, other = scene.keyframe.view, scene.keyframe.neighbours[3]
    pair = relate(key, other)
    pixels = np.array([[30.0, 40.0], [200.0, 17.0], [0.0, 0.0]])
    inverse_depth = np.array([0.7, 1.1, 2.0])
    homogeneous = np.c_[pixels, np.ones(3)] @ pair.infinite.T + inverse_depth[:, None] * pair.baseline
    expected, _ = project(other, backproject(key, pixels, 1 / inverse_depth))
    np.testing.assert_allclose(homogeneous[:, :2] / homogeneous[:, 2:], expected, rtol=1e-10)
    centre, _ = project(key, other.centre[None])
    if np.isfinite(centre).all():
        np.testing.assert_allclose(pair.epipole[:2] / pair.epipole[2], centre[0], rtol=1e-9)


@pytest.mark.parametrize("neighbour_focal", [200.0, 260.0])
def test_found_depth_is_true(make_scene, neighbour_focal):
    """Property: nearly every match is right within its own standard deviation; cameras may differ."""
    scene = make_scene(neighbour_focal=neighbour_focal)
    outcome, found, variance, truth = search_many(scene)
    match = outcome == FOUND
    assert match.mean() > 0.25
    deviation = np.abs(found - truth)[match] / np.sqrt(variance[match])
    # The variance allows for 4 grey levels of noise and half a pixel of line; this image has neither.
    assert np.median(deviation) < 0.5
    # A single search over the whole range meets false matches, which only the other neighbours can tell.
    assert np.mean(deviation > 2) < 0.1


def test_a_neighbour_of_another_shape_finds_the_same(make_scene):
    """Property: columns and rows taken off a neighbour; its camera moves along, and what is found in both is the same.

    But where the true place was taken off, and another one passes for it.
    """
    scene = make_scene()
    view, image, _ = scene.neighbours[0]
    camera = view.camera
    less = replace(camera, width=camera.width - 30, height=camera.height - 20, cx=camera.cx - 30, cy=camera.cy - 20)
    neighbours = (replace(view, camera=less), *scene.keyframe.neighbours[1:])
    images = {**scene.images, view.name: np.ascontiguousarray(image[20:, 30:])}
    cut = replace(scene, keyframe=replace(scene.keyframe, neighbours=neighbours), images=images)
    (outcome, whole, *_), (seen, part, *_) = search_many(scene), search_many(cut)
    both = (outcome == FOUND) & (seen == FOUND)
    assert both.sum() > 0.6 * (outcome == FOUND).sum()
    assert np.isclose(part[both], whole[both], rtol=1e-6).mean() > 0.99


def test_exposure_does_not_matter(make_scene):
    """Property: 25 grey levels brighter, the same matches at the same depths."""
    scene = make_scene(contrast=8.0)
    other = to_grey(scene.neighbours[0][1])
    plain, found, _, _ = search_many(scene)
    brighter, found_brighter, _, _ = search_many(scene, other=other + 25)
    np.testing.assert_array_equal(plain, brighter)
    # float32 grey levels near 150 round at 1e-5, sub-pixel places follow.
    np.testing.assert_allclose(found, found_brighter, rtol=1e-3)


def test_gradient_along_the_line_is_needed(make_scene):
    """Exact: stripes parallel to the (horizontal) epipolar lines say nothing about depth."""
    scene = make_scene()
    stripes = np.repeat((128 + 60 * np.sin(np.arange(180) / 2)).astype(np.float32)[:, None], 240, axis=1)
    assert search(scene, 120, 91, grey=stripes, other=stripes)[0] == NOT_SEARCHED


def test_repetition_is_rarely_a_match(make_scene):
    """Property: a periodic pattern has no distinct match on a line of many periods."""
    scene = make_scene()
    stripes = np.repeat((128 + 60 * np.sin(2 * np.pi * np.arange(240) / 8)).astype(np.float32)[None], 180, axis=0)
    outcomes = np.array([search(scene, u, 90, grey=stripes, other=stripes, neighbour=4)[0] for u in range(80, 160)])
    assert (outcomes != NOT_SEARCHED).sum() > 40
    # Samples of 8-pixel waves, interpolated linearly, differ between periods: a few pass for distinct.
    assert np.mean(outcomes == FOUND) < 0.2


def test_a_blank_neighbour_has_no_match(make_scene):
    """Exact: where all places are equal none is distinct."""
    scene = make_scene()
    outcome, *_ = search_many(scene, other=np.full(scene.depth.shape, 128, np.float32))
    assert FOUND not in outcome


def test_invalid_pixels_of_the_neighbour_are_not_matched(make_scene):
    """Exact: with nothing valid in the neighbour there is no search."""
    scene = make_scene()
    outcome, found, *_ = search_many(scene, other_valid=np.zeros(scene.depth.shape, bool))
    assert set(outcome) == {NOT_SEARCHED}
    assert np.isnan(found).all()


def test_a_longer_baseline_is_more_certain(make_scene):
    """Property: at 9 degrees the variance is lower than at 3; alpha^2 falls with the baseline squared."""
    scene = make_scene()
    narrow, wide = search_many(scene, neighbour=0), search_many(scene, neighbour=4)
    both = (narrow[0] == FOUND) & (wide[0] == FOUND)
    ratio = np.median(narrow[2][both] / wide[2][both])
    # (9 / 3)^2 = 9, but for the slightly different lines and steepness.
    assert 6 < ratio < 13


def test_variance_falls_with_contrast(make_scene):
    """Property: the photometric part dominates at low contrast, so twice the contrast lowers the variance."""
    low, high = search_many(make_scene(contrast=6.0)), search_many(make_scene(contrast=12.0))
    both = (low[0] == FOUND) & (high[0] == FOUND)
    assert np.median(high[2][both] / low[2][both]) < 0.8


def test_the_end_of_the_segment_is_not_a_minimum(make_scene):
    """Exact: whatever is found lies inside the segment, but for rounding up and the sub-pixel shift."""
    scene = make_scene()
    low, high = 1.6, 2.4
    outcome, found, *_ = search_many(scene, low=low, high=high, neighbour=4)
    inside = found[outcome == FOUND]
    # Two pixels of tolerance; one along the line is about 1 / 31 of inverse depth: focal length 200, baseline 0.157.
    assert len(inside) and inside.min() > low - 2 / 31 and inside.max() < high + 2 / 31


def test_no_sample_reads_an_invalid_pixel(make_scene):
    """Exact: what stands at invalid pixels of either image changes nothing, in any search, to the last bit."""
    scene = make_scene(neighbour_focal=90.0)  # few pixels in the neighbour: templates reach farthest in the keyframe
    valid = np.ones(scene.depth.shape, bool)
    valid[:, 100:103] = False
    valid[60:63] = False
    results = []
    for value in (0.0, 200.0):
        grey, other = to_grey(scene.image), to_grey(scene.neighbours[0][1])
        grey[~valid], other[~valid] = value, value
        # The same pixels in both: of those searched, the gradient too keeps away from what is invalid.
        searched = find_textured(np.where(valid, grey, 0), valid, 5.0, TEMPLATE_MARGIN)
        pixels = np.argwhere(searched)[::7]
        results.append([search(scene, u, v, grey=grey, other=other, other_valid=valid) for v, u in pixels])
    first, second = (np.array(part) for part in results)
    assert (first[:, 0] == FOUND).sum() > 20
    np.testing.assert_array_equal(first, second)
