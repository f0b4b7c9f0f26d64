"""Exact and oracle: pictures that differ from a photograph by known amounts."""

import numpy as np
import pytest

from threedfs.evaluate.figures import photo_figures
from threedfs.evaluate.photo_error import match_exposure, measure_photo


@pytest.fixture
def photo():
    """Return a photograph of 80 x 100 with levels from 60 to 190, smooth."""
    v, u = np.mgrid[:80, :100]
    waves = np.stack([np.sin(u / 9), np.cos(v / 7), np.sin((u + v) / 11)], axis=-1)
    return np.rint(125 + 64 * waves).astype(np.uint8)


@pytest.fixture
def where():
    """Return a disc."""
    v, u = np.mgrid[:80, :100]
    return (v - 40) ** 2 + (u - 50) ** 2 < 35**2


def test_identical_pictures_differ_by_nothing(photo, where):
    """Exact."""
    psnr, ssim = measure_photo(photo.astype(np.float32), photo, where)
    assert psnr > 200 and ssim == pytest.approx(1, abs=1e-9)


def test_where_nothing_differs_psnr_is_infinite(where):
    """Exact: of one colour all over."""
    grey = np.full((80, 100, 3), 100, np.uint8)
    assert measure_photo(grey.astype(np.float32), grey, where) == (np.inf, 1.0)


@pytest.mark.parametrize(("gain", "offset"), [(0.8, 0.0), (1.3, -20.0), (1.0, 25.0)])
def test_one_gain_and_one_offset_are_taken_out(photo, where, gain, offset):
    """Exact: they are the camera's."""
    picture = (gain * photo + offset).astype(np.float32)
    np.testing.assert_allclose(match_exposure(picture, photo, where), photo, atol=1e-3)
    psnr, ssim = measure_photo(picture, photo, where)
    assert psnr > 80 and ssim > 1 - 1e-6


def test_another_gain_in_one_channel_is_not_taken_out(photo, where):
    """Property: a wrong colour counts."""
    assert measure_photo((photo * [1.0, 1.0, 0.8]).astype(np.float32), photo, where)[0] < 32


@pytest.mark.parametrize("sigma", [2.0, 5.0, 10.0])
def test_noise_gives_the_psnr_that_it_has(photo, where, sigma):
    """Oracle: 20 log10 (255 / sigma), within 0.2 dB; the gain that fits best takes a little of strong noise away."""
    noise = np.random.default_rng(0).normal(0, sigma, photo.shape)
    psnr, ssim = measure_photo((photo + noise).astype(np.float32), photo, where)
    spread = photo[where].var()
    left = sigma**2 * spread / (spread + sigma**2)
    assert psnr == pytest.approx(10 * np.log10(255**2 / left), abs=0.1)
    assert sigma == 10 or psnr == pytest.approx(20 * np.log10(255 / sigma), abs=0.2)
    assert ssim < 0.999


def test_more_noise_is_less_similar(photo, where):
    noise = np.random.default_rng(0).normal(0, 1, photo.shape)
    found = [measure_photo((photo + sigma * noise).astype(np.float32), photo, where) for sigma in (1, 3, 10, 30)]
    assert found == sorted(found, reverse=True)


def test_a_shift_by_two_pixels_shows(photo, where):
    moved = np.roll(photo, 2, axis=1).astype(np.float32)
    psnr, ssim = measure_photo(moved, photo, where)
    assert psnr < 32 and ssim < 0.99


def test_pixels_elsewhere_do_not_count(photo, where):
    """Exact: whatever is in them."""
    noise = np.random.default_rng(0).normal(0, 5, photo.shape)
    picture = (photo + noise).astype(np.float32)
    spoiled = np.where(where[..., None], picture, 3.0).astype(np.float32)
    assert measure_photo(spoiled, photo, where) == measure_photo(picture, photo, where)


def test_a_picture_of_one_colour_is_matched_by_its_mean(photo, where):
    """Exact: without contrast there is no gain to find."""
    found = match_exposure(np.full(photo.shape, 7.0, np.float32), photo, where)
    np.testing.assert_allclose(found, photo[where].mean())


def test_figures_are_means_over_photographs():
    """Exact; none without photographs."""
    figures = photo_figures(np.array([[30.0, 0.9, 20.0, 0.7], [40.0, 0.8, 25.0, 0.6]]))
    found = {figure.name: (figure.value, figure.unit) for figure in figures}
    assert found == {
        "photo_psnr": (35, "dB"),
        "photo_ssim": (pytest.approx(0.85), "1"),
        "photo_psnr_vertices": (22.5, "dB"),
        "photo_ssim_vertices": (pytest.approx(0.65), "1"),
        "photos": (2, "photos"),
    }
    assert photo_figures(np.zeros((0, 4))) == []
