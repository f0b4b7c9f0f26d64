"""Colour of the object and of its background: Gaussian mixtures over all keyframes (Section 3.4, Eqs. 20, 21)."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from threedfs.segment.mixture import Mixture, log_density

_UNEXPECTED = 0.05
"""Share of the pixels on the support surface that do not look like it: highlights, things that stand on it."""
_LIKENESS = 3.0
"""Log ratio of the object's to the background's density from which a spot of the support surface looks like the object
rather than like a shadow."""


@dataclass(frozen=True)
class TableMatch:
    """How the support surface would look at pixels.

    Attributes
    ----------
    known : (...) bool
        Whether other views show it there.
    color : (..., 3) float32
        Lab.
    density : (...) float32
        Log density of the pixel's colour if it shows the support surface.
    beneath : (...) bool
        Whether solid stands on that spot: what views show there may be the object's own foot.
    """

    known: np.ndarray
    color: np.ndarray
    density: np.ndarray
    beneath: np.ndarray

    def at(self, mask: np.ndarray) -> TableMatch:
        """Return the pixels of a mask."""
        return TableMatch(self.known[mask], self.color[mask], self.density[mask], self.beneath[mask])


@dataclass(frozen=True)
class ColorModel:
    """Mixtures of the object's and of the background's colours in Lab."""

    of_object: Mixture
    of_background: Mixture

    def posterior(self, lab: np.ndarray, table: TableMatch | None = None) -> np.ndarray:
        """Return the probability (N,) float64 that pixels of colours (N, 3) show the object, at even odds before.

        Parameters
        ----------
        lab : (N, 3) float32
        table : TableMatch, optional
            Where it is known how the support surface looks at a pixel, the background is expected to look so, and its
            mixture keeps the share `_UNEXPECTED`. What looks like the object beneath it is not believed.
        """
        of_object, background = log_density(self.of_object, lab), log_density(self.of_background, lab)
        if table is not None and table.known.any():
            known = table.known
            doubt = np.zeros(known.sum())
            beneath = table.beneath[known]
            foot = table.color[known][beneath]
            lean = log_density(self.of_object, foot) - log_density(self.of_background, foot)
            doubt[beneath] = np.exp(np.clip(lean - _LIKENESS, -50, 50))
            trust = (1 - _UNEXPECTED) / (1 + doubt)
            expected = np.log(np.maximum(trust, 1e-300)) + table.density[known]
            background[known] = np.logaddexp(np.log(1 - trust) + background[known], expected)
        return 1 / (1 + np.exp(np.clip(background - of_object, -50, 50)))


def lab_from_rgb(rgb: np.ndarray) -> np.ndarray:
    """Return Lab colours (N, 3) float32 of RGB ones (N, 3) uint8."""
    return lab_image(rgb[None])[0] if len(rgb) else np.zeros((0, 3), np.float32)


def lab_image(image: np.ndarray) -> np.ndarray:
    """Return the Lab colours (H, W, 3) float32 of an RGB image (H, W, 3) uint8."""
    return cv2.cvtColor(image.astype(np.float32) / 255, cv2.COLOR_RGB2Lab)


def truncate(probability: np.ndarray, cap: float) -> np.ndarray:
    """Return the cost of a probability, -log, at most `cap` (Eq. 20)."""
    return np.minimum(cap, -np.log(np.maximum(probability, 1e-300)))
