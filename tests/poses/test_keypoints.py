"""Exact and property: keypoints, and which frames they are looked for in."""

from __future__ import annotations

import numpy as np
import pytest

from threedfs.poses.keypoints import choose_frames, describe_image, find_keypoints


def checks(rng, size):
    """Return a picture of grey squares of some size."""
    return np.repeat(np.kron(rng.integers(0, 256, (12, 16)), np.ones((size, size)))[..., None], 3, axis=2).astype(
        np.uint8
    )


@pytest.mark.parametrize("centre", [(40.0, 30.0), (51.3, 37.6)])
def test_a_blob_is_found_at_its_pixel_centre(centre):
    v, u = np.mgrid[:80, :100]
    blob = 40 + 180 * np.exp(-((u - centre[0]) ** 2 + (v - centre[1]) ** 2) / (2 * 3.0**2))
    image = np.repeat(np.rint(blob).astype(np.uint8)[..., None], 3, axis=2)
    found = describe_image(image, max_features=100, min_contrast=0.005)
    distance = np.linalg.norm(found.pixels - centre, axis=1)
    # Half a pixel would be 0.5, a quarter 0.25: SIFT's own bias on a symmetric blob is under 0.1.
    assert distance.min() < 0.1
    assert np.all(found.colors[distance.argmin()] >= 210)


def test_keypoints_do_not_depend_on_threads():
    rng = np.random.default_rng(3)
    images = [checks(rng, 10) for _ in range(5)]
    one, two = (
        find_keypoints(images.__getitem__, [0, 2, 4], max_features=500, min_contrast=0.005, threads=threads)
        for threads in (1, 2)
    )
    assert list(one) == list(two) == [0, 2, 4]
    for frame, left in one.items():
        assert len(left.pixels) > 50
        for name, values in vars(left).items():
            assert values.tobytes() == getattr(two[frame], name).tobytes()


def test_the_largest_are_kept_and_no_more_than_asked_for():
    rng = np.random.default_rng(4)
    coarse = checks(rng, 20)
    image = (0.7 * coarse + 0.3 * rng.integers(0, 256, coarse.shape)).astype(np.uint8)
    every = describe_image(image, max_features=5000, min_contrast=0.005)
    some = describe_image(image, max_features=60, min_contrast=0.005)
    assert len(every.pixels) > 200
    assert len(some.pixels) == 60
    assert {tuple(pixel) for pixel in some.pixels} <= {tuple(pixel) for pixel in every.pixels}


def test_descriptors_have_the_length_that_matching_expects():
    found = describe_image(checks(np.random.default_rng(5), 20), max_features=200, min_contrast=0.005)
    np.testing.assert_allclose(np.linalg.norm(found.descriptors.astype(float), axis=1), 512, rtol=0.02)  # bytes


def test_a_blank_image_has_no_keypoints():
    found = describe_image(np.full((60, 80, 3), 90, np.uint8), max_features=9, min_contrast=0.005)
    assert found.pixels.shape == (0, 2)
    assert found.descriptors.shape == (0, 128)


def test_frames_are_chosen_by_number_and_by_time():
    times = np.arange(151) / 6
    assert choose_frames(times, 75, 0.6, ordered=True) == list(range(0, 151, 3))
    assert choose_frames(times, 75, 0.4, ordered=True) == list(range(0, 151, 2))
    assert choose_frames(times * 5, 75, 0.4, ordered=True) == list(range(151))
    assert choose_frames(np.full(200, np.nan), 75, 0.4, ordered=False) == list(range(200))
