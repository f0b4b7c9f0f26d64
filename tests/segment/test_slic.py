"""Oracle, exact and property: superpixels by SLIC."""

import cv2
import numpy as np
import scipy.ndimage

from threedfs.segment.slic import _assign, _connect, cluster_pixels


def noisy_image(shape=(48, 64), seed=0):
    rng = np.random.default_rng(seed)
    image = np.where(np.arange(shape[1])[None, :, None] < 37, [200, 60, 40], [50, 80, 190])
    return np.clip(image + rng.normal(0, 8, (*shape, 3)), 0, 255).astype(np.uint8)


def test_pixels_go_to_the_nearest_centre_in_reach():
    """Oracle: the distance to every centre at once, with numpy."""
    rng = np.random.default_rng(1)
    lab = cv2.cvtColor(noisy_image().astype(np.float32) / 255, cv2.COLOR_RGB2Lab)
    valid = rng.random((48, 64)) < 0.9
    place = rng.random((12, 2)) * [48, 64]
    centres = np.concatenate([rng.normal(50, 20, (12, 3)), place], axis=1).astype(np.float32)
    nearest = np.empty((48, 64), np.int32)
    _assign(lab, valid, centres, 14, np.float32(0.7), nearest)
    v, u = np.mgrid[:48, :64]
    apart = np.stack([v, u], axis=-1)[:, :, None] - centres[:, 3:]
    distance = ((lab[:, :, None] - centres[:, :3]) ** 2).sum(-1) + 0.7 * (apart**2).sum(-1)
    whole = np.stack([v, u], axis=-1)[:, :, None] - centres[:, 3:].astype(int)
    distance[np.abs(whole).max(-1) > 14] = np.inf
    expected = np.where(valid & np.isfinite(distance.min(-1)), distance.argmin(-1), -1)
    assert np.array_equal(nearest, expected)


def test_small_pieces_join_their_neighbour():
    nearest = np.zeros((6, 8), np.int32)
    nearest[:, 5:] = 1
    nearest[2, 2] = 1  # apart from the rest of its cluster
    nearest[5, 0] = -1
    expected = np.where(np.arange(8) < 5, 0, 1) * np.ones((6, 1), int)
    expected[5, 0] = -1
    assert np.array_equal(_connect(nearest, 3), expected)


def test_pieces_are_connected_and_keep_to_the_edge():
    image, valid = noisy_image(), np.ones((48, 64), bool)
    valid[:5, :9] = False
    index = cluster_pixels(image, valid, area=64.0, compactness=10.0)
    assert np.array_equal(index < 0, ~valid)
    numbers = np.unique(index[valid])
    assert np.array_equal(numbers, np.arange(len(numbers))) and 36 <= len(numbers) <= 60
    assert all(scipy.ndimage.label(index == number)[1] == 1 for number in numbers)
    left = np.bincount(index[valid], np.broadcast_to(np.arange(64) < 37, valid.shape)[valid])
    assert np.isin(left, (0, *np.bincount(index[valid]))).all()  # none lies on both sides of the edge


def test_compact_pieces_cross_the_edge():
    left = np.broadcast_to(np.arange(64) < 37, (48, 64))
    shares = {}
    for compactness in (10.0, 1000.0):
        index = cluster_pixels(noisy_image(), np.ones((48, 64), bool), area=64.0, compactness=compactness)
        shares[compactness] = np.bincount(index.ravel(), left.ravel()) / np.bincount(index.ravel())
    assert np.isin(shares[10.0], (0, 1)).all() and not np.isin(shares[1000.0], (0, 1)).all()
