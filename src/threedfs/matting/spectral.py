"""The object's opacity in one image by spectral matting (Levin, Rav-Acha, Lischinski 2008), as the paper tried it."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import cv2
import numpy as np

from threedfs.frames.scale import shrink
from threedfs.matting.assign import assign_components
from threedfs.matting.components import ComponentRule, find_components
from threedfs.matting.laplacian import matting_laplacian
from threedfs.matting.trimap import Trimap

_MARGIN = 0.1
"""What the window around the over-estimate exceeds it by on each side, of the longer side."""
_FEWEST = 3
"""Pixels of the margin at least: a window of the Laplacian."""


@dataclass(frozen=True)
class SpectralRule:
    """How an image is matted; `SpectralMattingParams` says more of each value."""

    pixels: int
    epsilon: float
    components: ComponentRule


def matte_image(image: np.ndarray, trimap: Trimap, rule: SpectralRule, rng: np.random.Generator) -> np.ndarray:
    """Return the object's opacity (H, W) float32 in [0, 1] in an image.

    A window around the over-estimate is resampled to at most `rule.pixels` pixels and split into matting components;
    those that the trimap gives to the object are added up. What the trimap knows, stays.

    Parameters
    ----------
    image : (H, W, 3) uint8
        RGB.
    trimap : Trimap
        Where it knows nothing of the object, or nothing but the object, there is nothing to assign components by: its
        `inner` pixels are returned.
    rule : SpectralRule
    rng : numpy.random.Generator
    """
    if not trimap.unknown.any() or not trimap.inner.any():
        return trimap.inner.astype(np.float32)
    window = _surround(trimap.outer)
    part = Trimap(trimap.inner[window], trimap.outer[window])
    coarse = _coarse_shape(part.outer.shape, rule.pixels)
    small = Trimap(_average(part.inner, coarse) == 255, _average(part.outer, coarse) > 0)
    if not small.inner.any() or small.outer.all():
        return trimap.inner.astype(np.float32)
    laplacian = matting_laplacian(shrink(image[window], coarse), rule.epsilon)
    components = find_components(laplacian, rule.components, rng)
    alpha = components[:, assign_components(components, laplacian, small)].sum(axis=1).reshape(coarse)
    size = part.outer.shape[::-1]
    finer = cv2.resize(np.clip(alpha, 0, 1).astype(np.float32), size, interpolation=cv2.INTER_LINEAR)
    whole = np.zeros(trimap.outer.shape, np.float32)
    whole[window] = np.where(part.inner, 1, np.where(part.outer, finer, 0))
    return whole


def _surround(mask: np.ndarray) -> tuple[slice, slice]:
    """Return the window of an image that holds a mask (H, W) bool, with a margin."""
    spans = [np.flatnonzero(mask.any(axis=axis)) for axis in (1, 0)]
    margin = max(_FEWEST, int(_MARGIN * max(np.ptp(span) + 1 for span in spans)))
    return tuple(slice(max(0, int(span[0]) - margin), int(span[-1]) + margin + 1) for span in spans)


def _coarse_shape(shape: tuple[int, int], pixels: int) -> tuple[int, int]:
    """Return the largest shape of about the same proportions with at most so many pixels.

    Examples
    --------
    >>> _coarse_shape((300, 400), 30_000), _coarse_shape((30, 40), 30_000)
    ((150, 200), (30, 40))
    """
    factor = min(1.0, sqrt(pixels / (shape[0] * shape[1])))
    return tuple(max(1, int(side * factor + 1e-9)) for side in shape)


def _average(mask: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """Return the share of each coarse pixel that a mask covers, uint8 of 255."""
    return shrink(mask.astype(np.uint8) * 255, shape)
