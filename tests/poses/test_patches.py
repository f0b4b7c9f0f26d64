"""Oracle: a patch is found where an affine map has drawn it, to a few hundredths of a pixel."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from threedfs.poses.patches import Patches, follow_patches

TURN = np.radians(12.0)
MAP = 1.1 * np.array([[np.cos(TURN), -np.sin(TURN)], [np.sin(TURN), np.cos(TURN)]]) @ np.array([[1.0, 0.08], [0, 0.93]])
OFFSET = np.array([3.3, -20.6])


@pytest.fixture(scope="module")
def images():
    """Return a smooth texture, and the same drawn by the map, darker and with less contrast."""
    rng = np.random.default_rng(0)
    texture = cv2.GaussianBlur(rng.uniform(0, 255, (160, 200)).astype(np.float32), (0, 0), 2)
    texture = np.clip(128 + 5 * (texture - texture.mean()), 0, 255)
    drawn = cv2.warpAffine(texture, np.column_stack([MAP, OFFSET]), (200, 160), flags=cv2.INTER_CUBIC, borderValue=128)
    return np.stack([texture, 0.8 * drawn + 10, np.full_like(texture, 90)]).round().astype(np.uint8)


def patches_at(centre, *, shape, shift=(0.0, 0.0), target=1):
    count = len(centre)
    return Patches(
        np.zeros(count, np.int64),
        np.full(count, target),
        centre,
        centre @ MAP.T + OFFSET + shift,
        np.broadcast_to(shape, (count, 2, 2)).copy(),
    )


CENTRE = np.stack(np.meshgrid(np.arange(60.0, 140, 9.3), np.arange(50.0, 110, 8.7)), axis=-1).reshape(-1, 2)


@pytest.mark.parametrize("shape", [MAP, np.eye(2)], ids=["known shape", "shape to be found"])
def test_a_patch_is_found_where_it_was_drawn(images, shape):
    looked_for = patches_at(CENTRE, shape=shape, shift=(1.2, -0.9))
    pixels, correlation = follow_patches(images, looked_for, radius=7, max_shift=4.0, threads=1)
    found = correlation > 0.95
    assert found.mean() > 0.9
    error = np.linalg.norm(pixels - (CENTRE @ MAP.T + OFFSET), axis=1)[found]
    # Grey levels are whole numbers, both pictures are interpolated: a hundredth or two remain.
    assert np.median(error) < 0.03


def test_a_patch_is_not_found_where_there_is_nothing(images):
    _, correlation = follow_patches(images, patches_at(CENTRE, shape=MAP, target=2), radius=7, max_shift=4.0, threads=1)
    assert (correlation == -1).all()
    flat = Patches(np.full(1, 2), np.zeros(1, int), np.full((1, 2), 80.0), np.full((1, 2), 80.0), np.eye(2)[None])
    assert follow_patches(images, flat, radius=7, max_shift=4.0, threads=1)[1] == [-1]


def test_a_patch_is_not_found_farther_away_than_asked_for(images):
    far = patches_at(CENTRE, shape=MAP, shift=(2.0, 0.0))
    pixels, correlation = follow_patches(images, far, radius=7, max_shift=1.0, threads=1)
    found = correlation >= 0
    assert (np.abs(pixels - far.expected)[found] <= 1.0).all()
    assert found.mean() < 0.2


def test_a_patch_outside_of_the_image_is_not_found(images):
    edge = np.array([[3.0, 80.0], [80.0, 157.0]])
    assert (follow_patches(images, patches_at(edge, shape=MAP), radius=7, max_shift=4.0, threads=1)[1] == -1).all()


def test_places_do_not_depend_on_threads(images):
    looked_for = patches_at(np.repeat(CENTRE, 2, axis=0), shape=np.eye(2), shift=(0.7, 0.7))
    one, three = (follow_patches(images, looked_for, radius=6, max_shift=4.0, threads=threads) for threads in (1, 3))
    assert all(left.tobytes() == right.tobytes() for left, right in zip(one, three, strict=True))
