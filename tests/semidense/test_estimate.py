"""Semi-dense depth of whole keyframes against exact depth."""

from __future__ import annotations

import numpy as np
import pytest

from threedfs.params.semidense import SemidenseParams
from threedfs.semidense.epipolar import SearchRule
from threedfs.semidense.estimate import FusionRule, estimate_semidense, order_by_baseline


def estimate(scene, sparse=None, valid=None, **changes):
    params = SemidenseParams(**changes)
    return estimate_semidense(
        scene.keyframe,
        scene.image,
        np.ones(scene.depth.shape, bool) if valid is None else valid,
        scene.neighbours,
        scene.sparse if sparse is None else sparse,
        SearchRule(*(getattr(params, name) for name in SearchRule._fields)),
        FusionRule(*(getattr(params, name) for name in FusionRule._fields)),
    )


def share_within(scene, inverse_depth, share=0.02):
    known = np.isfinite(inverse_depth)
    return np.mean(np.abs(1 / inverse_depth[known] / scene.depth[known] - 1) < share)


@pytest.mark.parametrize(
    "scene_of",
    [{}, {"shape": "sphere"}, {"noise": 3.0}, {"gain": 8.0}, {"neighbour_focal": 260.0}],
    ids=["plane", "sphere", "noise", "exposure", "focal"],
)
@pytest.mark.parametrize("start", ["sparse points", "nothing"])
def test_depth_is_true_on_textured_surfaces(make_scene, scene_of, start):
    """Oracle: most textured pixels get a depth, and 98 % of those are within 2 % of the exact one."""
    scene = make_scene(**scene_of)
    inverse_depth, variance = estimate(scene, sparse=np.empty((0, 3)) if start == "nothing" else None)
    assert inverse_depth.dtype == variance.dtype == np.float32
    # Cameras of longer focal length see half of the keyframe's area, and only what three of them see is kept.
    assert np.isfinite(inverse_depth).mean() > (0.2 if "neighbour_focal" in scene_of else 0.35)
    np.testing.assert_array_equal(np.isfinite(inverse_depth), np.isfinite(variance))
    assert share_within(scene, inverse_depth) > 0.98


def test_variance_tells_the_error(make_scene):
    """Property: errors are within 3 standard deviations for 95 % of the points, within 0.1 for few."""
    scene = make_scene(contrast=5.0, noise=3.0)
    inverse_depth, variance = estimate(scene)
    known = np.isfinite(inverse_depth)
    error = np.abs(inverse_depth - 1 / scene.depth)[known]
    assert np.mean(error <= 3 * np.sqrt(variance[known])) > 0.95
    # A variance that were merely large would hold here too.
    assert np.mean(error <= 0.1 * np.sqrt(variance[known])) < 0.6


@pytest.mark.parametrize("noise", [2.0, 4.0, 8.0])
def test_noise_is_not_a_match(make_scene, noise):
    """Property: on a blank surface under noise, fewer than 1 pixel in 100 gets a depth."""
    scene = make_scene(contrast=0.0, noise=noise)
    inverse_depth, _ = estimate(scene)
    assert np.isfinite(inverse_depth).mean() < 0.01


def test_mirrored_neighbours_leave_few_points(make_scene):
    """Property: images upside down show no surface, so few pixels find neighbours that agree by chance."""
    scene = make_scene()
    flipped = {name: image[::-1].copy() for name, image in scene.images.items()}
    wrong = type(scene)(scene.keyframe, scene.image, flipped, scene.depth, scene.sparse)
    right = np.isfinite(estimate(scene)[0]).sum()
    # The texture is smooth and the same everywhere, so five samples do meet their like: the worst case there is.
    assert np.isfinite(estimate(wrong)[0]).sum() < 0.15 * right


def test_invalid_pixels_get_no_depth(make_scene):
    """Exact: nothing outside the valid image nor within 3 pixels of its border."""
    scene = make_scene()
    valid = np.zeros(scene.depth.shape, bool)
    valid[30:150, 40:200] = True
    inverse_depth, _ = estimate(scene, valid=valid)
    assert np.isfinite(inverse_depth[33:147, 43:197]).any()
    inverse_depth[33:147, 43:197] = np.nan
    assert np.isnan(inverse_depth).all()


def test_more_support_gives_fewer_points(make_scene):
    """Property: fewer pixels have three neighbours that agree than one; half of the six is the most asked for."""
    scene = make_scene(shape="sphere")
    counts = [np.isfinite(estimate(scene, min_support=support, min_agreement=0.0)[0]).sum() for support in (1, 3)]
    assert counts[0] > counts[1] > 0


def test_points_beyond_the_depth_range_are_not_used(make_scene):
    """Property: sparse points with absurd depths neither break the estimate nor mislead it."""
    scene = make_scene()
    stray = scene.keyframe.view.centre + np.array([[0, 0, 50.0], [0.01, 0, 0.05]])
    inverse_depth, _ = estimate(scene, sparse=np.vstack([scene.sparse, stray]))
    assert share_within(scene, inverse_depth) > 0.98


def test_result_is_the_same_every_time(make_scene):
    """Exact: the same bytes twice."""
    scene = make_scene()
    first, second = estimate(scene), estimate(scene)
    assert first[0].tobytes() == second[0].tobytes() and first[1].tobytes() == second[1].tobytes()


def test_the_nearest_neighbour_observes_first(make_scene):
    """Exact: ascending baseline."""
    keyframe = make_scene().keyframe
    distance = [np.linalg.norm(view.centre - keyframe.view.centre) for view in order_by_baseline(keyframe)]
    assert distance == sorted(distance)
