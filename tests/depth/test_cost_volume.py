"""Oracle, exact and property: ZNCC against loops, and the cost volume on a plane of known depth."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
import scenes

from threedfs.depth.candidates import space_candidates
from threedfs.depth.cost_volume import choose_patch_radius, compute_cost_volume, plane_homographies
from threedfs.depth.evidence import gather_evidence
from threedfs.depth.zncc import MISSING, accumulate_cost, describe_patches, prepare_grey
from threedfs.geometry.projection import backproject, project
from threedfs.geometry.rigid import make_transform
from threedfs.types import Keyframe, View


def zncc_cost(reference, warped, radius, floor=0.0):
    patches = describe_patches(reference, radius, floor)
    grey = np.where(reference > MISSING / 2, reference, np.float32(0))
    cost = np.zeros_like(reference)
    column, patch = np.empty((2, 3, reference.shape[1]), np.float32)
    accumulate_cost(
        warped,
        grey,
        patches.mean,
        patches.inverse_deviation,
        radius,
        np.float32(floor),
        np.float32(0.5),
        column,
        patch,
        cost,
    )
    return cost


def random_pair(seed=0, shape=(20, 30)):
    rng = np.random.default_rng(seed)
    return [rng.uniform(-120, 120, shape).astype(np.float32) for _ in range(2)]


def test_zncc_equals_numpys_correlation_coefficient():
    """Single-precision sums over at most 25 values below 128^2: 1e-4 is a hundred of their roundings."""
    reference, warped = random_pair()
    for radius in (1, 2):
        cost = zncc_cost(reference, warped, radius)
        for v, u in [(radius, radius), (9, 14), (19 - radius, 29 - radius)]:
            window = np.s_[v - radius : v + radius + 1, u - radius : u + radius + 1]
            expected = (1 - np.corrcoef(reference[window].ravel(), warped[window].ravel())[0, 1]) / 2
            assert abs(cost[v, u] - expected) < 1e-4


def test_gain_and_offset_do_not_change_the_cost():
    reference, warped = random_pair(1)
    assert np.allclose(zncc_cost(reference, warped, 1), zncc_cost(reference, 0.5 * warped + 7, 1), atol=1e-4)


def test_a_variance_floor_keeps_noise_from_matching():
    """Two equal patches of noise far below the floor cost nearly 0.5, the cost of no correlation."""
    noise = random_pair(2)[0] * np.float32(0.01)
    assert zncc_cost(noise, noise, 1, floor=0.0)[5, 5] < 0.01
    assert zncc_cost(noise, noise, 1, floor=100.0)[5, 5] > 0.49


def test_missing_pixels_are_charged():
    reference, warped = random_pair(3)
    warped[10, 15] = MISSING
    cost = zncc_cost(reference, warped, 1)
    assert np.all(cost[9:12, 14:17] == 0.5)
    assert np.all(cost[0] == 0.5) and np.all(cost[:, -1] == 0.5)


def test_homographies_agree_with_projection():
    reference, neighbour = scenes.views()[:2]
    pixel = np.array([20.0, 30.0])
    depths = np.array([0.8, 1.3, 4.0])
    expected = [project(neighbour, backproject(reference, pixel, depth))[0] for depth in depths]
    mapped = plane_homographies(reference, neighbour, depths) @ [*pixel, 1]
    assert np.allclose(mapped[:, :2] / mapped[:, 2:], expected, atol=1e-10)


def test_least_cost_lies_at_the_true_depth():
    """Nearest candidate within one step for 95 % of the pixels: the rest see patches beyond a neighbour's border."""
    reference, *neighbours = scenes.views()
    images = scenes.grey_images()
    candidates = space_candidates(0.6, 1.8, 48, "inverse")
    cost = compute_cost_volume(
        reference,
        images["0"],
        neighbours,
        lambda view: images[view.name],
        candidates,
        patch_radius=1,
        variance_floor=0.0,
        missing_cost=0.5,
    )
    assert cost.shape == (48, 72, 96) and cost.dtype == np.float32
    assert cost.min() >= 0 and cost.max() <= 1.0001
    truth = scenes.plane_depth(reference)
    nearest = np.abs(1 / candidates[:, None, None] - 1 / truth).argmin(0)
    inner = np.s_[12:-12, 12:-12]
    assert (np.abs(cost.argmin(0) - nearest)[inner] <= 1).mean() > 0.95


def test_a_neighbour_of_another_shape_costs_the_same():
    """Property: columns and rows taken off a neighbour whose part is seen; the map moves with its principal point."""
    reference, neighbour = scenes.views()[:2]
    images = scenes.grey_images()
    camera = neighbour.camera
    less = replace(camera, width=camera.width - 7, height=camera.height - 5, cx=camera.cx - 7, cy=camera.cy - 5)
    cut = replace(neighbour, camera=less)
    cost = {}
    for view, image in ((neighbour, images[neighbour.name]), (cut, images[neighbour.name][5:, 7:])):
        cost[image.shape] = compute_cost_volume(
            reference,
            images["0"],
            [view],
            lambda view, image=image: image,
            space_candidates(0.9, 1.2, 4, "inverse"),
            patch_radius=1,
            variance_floor=1.0,
            missing_cost=0.5,
        )
    whole, part = cost.values()
    seen = part != 0.5
    assert seen.mean() > 0.6 and np.abs(part - whole)[seen].max() < 5e-3


def test_invalid_pixels_are_missing():
    valid = np.ones((4, 5), bool)
    valid[0] = False
    grey = prepare_grey(np.full((4, 5, 3), 200, np.uint8), valid)
    assert np.all(grey[0] == MISSING) and np.all(grey[1:] == 72)


def test_the_cost_stays_within_its_range_on_saturated_patches():
    """Without a floor, single-precision rounding must not pass for a correlation beyond 1."""
    rng = np.random.default_rng(4)
    reference, warped = (np.float32(127) - (rng.random((30, 30)) > 0.9).astype(np.float32) for _ in range(2))
    cost = zncc_cost(reference, warped, 1, floor=0.0)
    assert cost.min() >= 0 and cost.max() <= 1


def test_a_sample_that_barely_leaves_the_image_is_missing():
    """An image shifted by 0.02 px against itself: the last columns have no partner, the others match."""
    reference = random_pair(5)[0]
    shifted = cv2.warpPerspective(
        reference,
        np.array([[1, 0, 0.02], [0, 1, 0], [0, 0, 1.0]]),
        reference.shape[::-1],
        flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
        borderMode=cv2.BORDER_CONSTANT,
        borderValue=float(MISSING),
    )
    cost = zncc_cost(reference, shifted, 1)
    assert np.all(cost[1:-1, -2] == 0.5)
    assert cost[1:-1, 1:-2].max() < 0.01


def test_a_plane_behind_the_neighbour_is_missing():
    """The neighbour stands beyond the nearest plane: whatever is mirrored there must not match."""
    reference = scenes.views()[0]
    ahead = View("ahead", scenes.CAMERA, make_transform(np.eye(3), [0, 0, -0.8]))
    image = scenes.grey_images()["0"]
    cost = compute_cost_volume(
        reference,
        image,
        [ahead],
        lambda view: image,
        np.array([0.5, 0.6, 0.7]),
        patch_radius=1,
        variance_floor=1.0,
        missing_cost=0.5,
    )
    assert np.all(cost == 0.5)


def test_patches_grow_with_the_gaps_between_views():
    """Angles of 5, 21 and 60 degrees at a point 1 unit ahead give radii 1, 2 and 4, the largest."""
    reference = scenes.views()[0]
    for degrees, radius in ((5, 1), (21, 2), (60, 4)):
        angle = np.radians(degrees)
        turned = make_transform(np.eye(3), [-np.sin(angle), 0, np.cos(angle) - 1])
        keyframe = Keyframe(reference, (View("turned", scenes.CAMERA, turned),), 1.0, 1.0)
        assert keyframe.neighbour_angle == pytest.approx(degrees)
        assert choose_patch_radius(keyframe.neighbour_angle) == radius


def test_candidates_of_the_evidence_are_denser_where_the_box_is():
    """Contract: what a keyframe knows of its box reaches the candidates; one that knows nothing has even steps."""
    views = scenes.views()
    images = {view.name: np.full((*scenes.CAMERA.shape, 3), 128, np.uint8) for view in views}

    def candidates(within, outside_step):
        found = gather_evidence(
            Keyframe(views[0], tuple(views[1:2]), 0.5, 3.0, within),
            images.__getitem__,
            lambda name: np.ones(scenes.CAMERA.shape, bool),
            candidates=32,
            spacing="inverse",
            outside_step=outside_step,
            patch_radius=1,
            variance_floor=1.0,
            missing_cost=0.5,
            confidence_falloff=15.0,
            texture_half_variance=0.0,
        )
        return found.candidates

    even = candidates(None, 4.0)
    np.testing.assert_allclose(1 / even, np.linspace(1 / 0.5, 1 / 3.0, 32))
    np.testing.assert_array_equal(candidates((1.0, 1.5), 1.0), even)
    dense = candidates((1.0, 1.5), 4.0)
    inside = [np.count_nonzero((found >= 1.0) & (found <= 1.5)) for found in (even, dense)]
    assert inside[1] > 2 * inside[0]
