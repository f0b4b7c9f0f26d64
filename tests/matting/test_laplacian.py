"""Exact and oracle: the matting Laplacian against what it is made for."""

from __future__ import annotations

import numpy as np
import pytest

from threedfs.matting.laplacian import matting_laplacian

EPSILON = 1e-5


def picture(shape=(12, 15), seed=0) -> np.ndarray:
    """Return an image of smooth colours with noise."""
    rng = np.random.default_rng(seed)
    ramp = np.linspace(0, 200, shape[0] * shape[1]).reshape(shape)
    return np.clip(ramp[..., None] * (1, 0.6, 0.3) + rng.normal(20, 12, (*shape, 3)), 0, 255).astype(np.uint8)


def test_rows_sum_to_zero_and_the_matrix_is_symmetric():
    found = matting_laplacian(picture(), EPSILON)
    assert np.abs(found.sum(axis=1)).max() < 1e-9
    assert (found != found.T).nnz == 0


def test_no_opacity_costs_less_than_nothing():
    values = np.linalg.eigvalsh(matting_laplacian(picture(), EPSILON).toarray())
    assert values[0] > -1e-9 and np.count_nonzero(values < 1e-9) == 1


def test_an_opacity_linear_in_colour_costs_what_epsilon_takes_for_its_slope():
    """Exact: every window may take the opacity's own slope, for which it pays epsilon times its square."""
    image, slope = picture(), np.array([0.7, -0.2, 0.4])
    opacity = (image / 255.0 @ slope + 0.1).reshape(-1)
    windows = (image.shape[0] - 2) * (image.shape[1] - 2)
    for epsilon in (1e-9, EPSILON):
        cost = opacity @ (matting_laplacian(image, epsilon) @ opacity)
        assert -1e-12 < cost <= windows * epsilon * (slope**2).sum()
    stripes = np.indices(image.shape[:2])[1].reshape(-1) % 2
    assert stripes @ (matting_laplacian(image, EPSILON) @ stripes) > 1000 * cost


def test_in_one_colour_windows_ask_for_one_opacity():
    """Exact: nothing is left of a window but the distance of its pixels from their mean."""
    found = matting_laplacian(np.full((3, 3, 3), 77, np.uint8), EPSILON).toarray()
    np.testing.assert_allclose(found, np.eye(9) - 1 / 9, atol=1e-12)


def test_cost_is_that_of_the_best_line_in_every_window():
    """Oracle: ridge regression of the opacity on colour, window by window."""
    image = picture((6, 7))
    opacity = np.random.default_rng(1).random(image.shape[:2])
    cost = 0.0
    for row in range(4):
        for column in range(5):
            part = np.s_[row : row + 3, column : column + 3]
            lines = np.column_stack([image[part].reshape(-1, 3) / 255.0, np.ones(9)])
            damped = np.vstack([lines, np.sqrt(EPSILON) * np.eye(4)[:3]])
            wanted = np.append(opacity[part].reshape(-1), np.zeros(3))
            best = np.linalg.lstsq(damped, wanted, rcond=None)[0]
            cost += ((damped @ best - wanted) ** 2).sum()
    flat = opacity.reshape(-1)
    assert flat @ (matting_laplacian(image, EPSILON) @ flat) == pytest.approx(cost, rel=1e-9)


def test_rows_of_asked_pixels_are_those_of_the_whole():
    image, within = picture(), np.zeros((12, 15), bool)
    within[4:7, 5:9] = True
    whole, part = (matting_laplacian(image, EPSILON, asked).toarray() for asked in (None, within))
    asked = within.reshape(-1)
    np.testing.assert_allclose(part[asked], whole[asked], atol=1e-12)
    assert not part[:15].any()
