"""How close a picture of a coloured mesh comes to a photograph of the object."""

from __future__ import annotations

import numpy as np
from skimage.metrics import structural_similarity

_PEAK = 255.0
_SIGMA = 1.5
"""Of SSIM's windows, pixels."""
_REACH = 8
"""Pixels that no window goes beyond."""


def match_exposure(picture: np.ndarray, photo: np.ndarray, where: np.ndarray) -> np.ndarray:
    """Return the picture (H, W, 3) by the one gain, not below 0, and offset that bring it closest to the photo."""
    x, y = picture[where].ravel().astype(np.float64), photo[where].ravel().astype(np.float64)
    spread = x.var()
    gain = max(0.0, ((x - x.mean()) * (y - y.mean())).mean() / spread) if spread > 0 else 1.0
    return gain * picture + (y.mean() - gain * x.mean())


def measure_photo(picture: np.ndarray, photo: np.ndarray, where: np.ndarray) -> tuple[float, float]:
    """Return PSNR in dB and SSIM of a picture against a photograph, over the pixels that show the object.

    Parameters
    ----------
    picture : (H, W, 3) float32
    photo : (H, W, 3) uint8
    where : (H, W) bool
        Pixels that count; SSIM's windows see the two equal in all others.

    Returns
    -------
    tuple of float
        After one gain and one offset for the whole picture. PSNR is infinite where nothing differs.
    """
    window = _enclose(where)
    picture, photo, where = picture[window], photo[window], where[window]
    matched = np.where(where[..., None], np.clip(match_exposure(picture, photo, where), 0, _PEAK), photo)
    error = float(((matched[where] - photo[where]) ** 2).mean())
    similar = structural_similarity(
        matched,
        photo.astype(np.float64),
        data_range=_PEAK,
        channel_axis=2,
        gaussian_weights=True,
        sigma=_SIGMA,
        use_sample_covariance=False,
        full=True,
    )[1]
    psnr = 10 * np.log10(_PEAK**2 / error) if error > 0 else np.inf
    return float(psnr), float(similar[where].mean())


def _enclose(where: np.ndarray) -> tuple[slice, slice]:
    """Return the rows and columns around what is marked (H, W) bool that SSIM's windows there read."""
    spans = (np.flatnonzero(where.any(axis=axis)) for axis in (1, 0))
    return tuple(slice(max(span[0] - _REACH, 0), span[-1] + _REACH + 1) for span in spans)
