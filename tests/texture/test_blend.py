"""Oracle and exact: the median of what photographs show of a point."""

import numpy as np
import pytest
from painted_ball import CAMERA, look_from, ring

import threedfs.texture.blend as blend


def test_medians_are_those_of_repeated_samples():
    """Oracle: a sample of weight 3 counts as three; where two are in the middle, the lower one."""
    generator = np.random.default_rng(0)
    samples = generator.integers(0, 256, (200, 7, 3), np.uint8)
    weights = generator.integers(0, 4, (200, 7)).astype(np.float32)
    weights[weights.sum(axis=1) == 0, 0] = 1
    found = blend._weighted_median(samples, weights)
    for row in range(200):
        repeated = np.sort(np.repeat(samples[row], weights[row].astype(int), axis=0), axis=0)
        np.testing.assert_array_equal(found[row], repeated[(len(repeated) - 1) // 2])


@pytest.fixture
def greys():
    """Five photographs, each of one grey level."""
    return {
        view.name: np.full((*CAMERA.shape, 3), level, np.uint8)
        for view, level in zip(ring(5), (10, 20, 30, 200, 250), strict=True)
    }


def test_large_views_count_more_and_views_of_no_area_not_at_all(greys):
    """Exact."""
    areas = np.array([[1, 1, 1, 1, 1], [0, 0, 1, 1, 1], [1, 1, 1, 9, 1], [0, 0, 0, 0, 0.5]], np.float32)
    points = np.zeros((4, 3))
    found = blend.blend_photographs(points, np.arange(4), areas, ring(5), greys.__getitem__)
    assert found.tolist() == [[30] * 3, [200] * 3, [200] * 3, [250] * 3]


def test_colours_are_read_between_pixels():
    """Exact: of a ramp, a level to a pixel."""
    views = [look_from(angle) for angle in (0.0, 0.4)]
    ramp = np.broadcast_to(np.arange(160, dtype=np.uint8)[None, :, None], (160, 160, 3))
    points = np.random.default_rng(1).uniform(-0.2, 0.2, (50, 3))
    areas, face = np.array([[2, 1]], np.float32), np.zeros(50, np.int64)
    found = blend.blend_photographs(points, face, areas, views, lambda name: ramp)
    column = views[0].cam_from_world[:3] @ np.column_stack([points, np.ones(50)]).T
    np.testing.assert_allclose(found[:, 0], CAMERA.fx * column[0] / column[2] + CAMERA.cx, atol=0.55)
