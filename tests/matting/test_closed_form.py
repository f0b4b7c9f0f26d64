"""Oracle and property: opacity near an outline, against a dense solver and against exact coverage."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from ball import ball_scene, view_from

from threedfs.matting.closed_form import BAND, matte_outline, solve_opacity
from threedfs.matting.laplacian import matting_laplacian
from threedfs.matting.trimap import Trimap, trimap_around
from threedfs.segment.outline import depth_inside
from threedfs.synthetic.render import Renderer
from threedfs.synthetic.sensor import Sensor
from threedfs.synthetic.solid import Material
from threedfs.synthetic.textures import speckled
from threedfs.types import View

SAMPLES = 8
_CROSS = cv2.getStructuringElement(cv2.MORPH_CROSS, (3, 3))


@pytest.fixture(scope="module")
def shot():
    """A rendered image of a speckled ball, and the share of each pixel that the ball covers, of 64 rays."""
    renderer = Renderer(ball_scene(Material(speckled((0.5, 0.1, 0.1), (0.6, 0.3, 0.2), 0.02, 0.4))), 8, 8)
    view, light, cover = view_from((0.5, 0.1, 0.35)), 0.0, 0.0
    for u in (np.arange(SAMPLES) + 0.5) / SAMPLES - 0.5:
        for v in (np.arange(SAMPLES) + 0.5) / SAMPLES - 0.5:
            camera = replace(view.camera, cx=view.camera.cx - u, cy=view.camera.cy - v)
            light = light + renderer.radiance(view, (u, v))
            cover = cover + renderer.mask(View("", camera, view.cam_from_world))
    return Sensor(seed=1).record(light / SAMPLES**2, 0, 0.0), cover / SAMPLES**2


def change(mask: np.ndarray, pixels: int) -> np.ndarray:
    """Return a mask grown by so many pixels, or shrunk."""
    work = cv2.dilate if pixels > 0 else cv2.erode
    return work(mask.astype(np.uint8), _CROSS, iterations=abs(pixels)) > 0


def test_opacity_is_that_of_a_dense_solver():
    """Oracle."""
    rng = np.random.default_rng(0)
    image = rng.integers(0, 255, (13, 17, 3)).astype(np.uint8)
    mask = np.indices((13, 17)).sum(axis=0) < 14
    trimap = Trimap(np.indices((13, 17))[1] < 4, np.indices((13, 17))[1] < 12)
    for trust in (0.0, 0.2):
        matrix = matting_laplacian(image, 1e-4).toarray()
        unknown, held = trimap.unknown.reshape(-1), trimap.inner.reshape(-1).astype(float)
        square = matrix[np.ix_(unknown, unknown)] + trust * np.eye(unknown.sum())
        right = trust * mask.reshape(-1)[unknown] - matrix[np.ix_(unknown, ~unknown)] @ held[~unknown]
        expected = held.copy()
        expected[unknown] = np.clip(np.linalg.solve(square, right), 0, 1)
        found = solve_opacity(image, mask, trimap, 1e-4, trust)
        np.testing.assert_allclose(found.reshape(-1), expected, atol=1e-9)


def test_blend_of_two_colours_is_taken_apart():
    """Exact: where colour is linear in opacity, opacity is found to a level of the image."""
    true = np.clip((np.indices((30, 40))[1] - 18.2) / 3, 0, 1)
    image = np.rint(true[..., None] * (220, 180, 60) + (1 - true[..., None]) * (30, 60, 120)).astype(np.uint8)
    found = solve_opacity(image, true > 0.5, trimap_around(true > 0.5, BAND), 1e-6, 0.0)
    assert np.abs(found - true)[:, 1:-1].max() < 0.02


@pytest.mark.parametrize(("wrong", "share"), [(1, 0.8), (-1, 0.8), (2, 0.85), (-2, 0.85)])
def test_opacity_is_nearer_to_the_coverage_than_a_mask_that_is_wrong(shot, wrong, share):
    """Property: by exact coverage of rendered pixels."""
    image, cover = shot
    mask = change(cover > 0.5, wrong)
    near = np.abs(depth_inside(cover > 0.5)) < 6
    before, after = (np.abs(guess - cover)[near].mean() for guess in (mask, matte_outline(image, mask)))
    assert after < share * before


def test_an_exact_mask_stays_near_the_coverage(shot):
    image, cover = shot
    near = np.abs(depth_inside(cover > 0.5)) < 6
    assert np.abs(matte_outline(image, cover > 0.5) - cover)[near].mean() < 0.04


def test_only_the_band_is_soft(shot):
    image, cover = shot
    mask = cover > 0.5
    found = matte_outline(image, mask)
    far = np.abs(depth_inside(mask)) > BAND
    np.testing.assert_array_equal(found[far], mask[far])
    assert 0 < ((found > 0.02) & (found < 0.98)).mean() < 0.1


@pytest.mark.parametrize("full", [False, True])
def test_a_mask_without_an_outline_is_its_own_opacity(shot, full):
    mask = np.full(shot[1].shape, full)
    np.testing.assert_array_equal(matte_outline(shot[0], mask), mask)
    assert not trimap_around(mask, 3.0).unknown.any()


def test_a_part_narrower_than_the_band_stays():
    """Regression: with no pixel that is known to be object, a wire would vanish without trust in the mask."""
    image = np.full((30, 40, 3), 60, np.uint8)
    image[14:16] = (200, 180, 90)
    mask = image[..., 0] > 100
    assert matte_outline(image, mask)[14:16].min() > 0.9
    assert solve_opacity(image, mask, trimap_around(mask, 3.0), 1e-6, 0.0).max() < 0.1
