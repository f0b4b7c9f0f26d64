"""Opacity near the outline of a mask, in closed form (Levin, Lischinski, Weiss 2008)."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.ndimage import find_objects

from threedfs.matting.laplacian import factorise, matting_laplacian
from threedfs.matting.trimap import Trimap, trimap_around

BAND = 2.0
"""Pixels to both sides of an outline where opacity is solved for: as far as our masks are wrong."""
EPSILON = 1e-4
"""See `matting_laplacian`."""
TRUST = 0.1
"""Weight of the mask within the band: it decides where colours tell little, and where a part is narrower."""

_RIM = 2
"""Pixels around unknown ones that share a window with them."""


def matte_outline(image: np.ndarray, mask: np.ndarray) -> np.ndarray:
    """Return the opacity (H, W) float64 in [0, 1] of what a mask marks: 0 or 1 but for a band about its outline.

    Parameters
    ----------
    image : (H, W, 3) uint8
        RGB.
    mask : (H, W) bool
    """
    return solve_opacity(image, mask, trimap_around(mask, BAND), EPSILON, TRUST)


def solve_opacity(image: np.ndarray, mask: np.ndarray, trimap: Trimap, epsilon: float, trust: float) -> np.ndarray:
    """Return the opacity (H, W) float64 in [0, 1] that is nearest to a linear function of colour in every window.

    Minimises x^T L x (Eq. 11 of the source) over the unknown pixels, all others held. Differs from the source: the
    squared distance of x from a mask counts too. The system is solved by a factorisation, without iterations.

    Parameters
    ----------
    image : (H, W, 3) uint8
        RGB.
    mask : (H, W) bool
    trimap : Trimap
    epsilon : float
        See `matting_laplacian`.
    trust : float
        Weight of the mask. With 0, unknown pixels that no window joins to known ones have no solution.
    """
    opacity = trimap.inner.astype(np.float64)
    if not trimap.unknown.any():
        return opacity
    (box,) = find_objects(trimap.unknown.astype(np.uint8))
    window = tuple(slice(max(0, side.start - _RIM), side.stop + _RIM) for side in box)
    unknown, held = trimap.unknown[window], opacity[window].reshape(-1)
    rows = matting_laplacian(image[window], epsilon, unknown)[unknown.reshape(-1)]
    matrix = rows[:, np.flatnonzero(unknown)] + trust * sparse.eye_array(np.count_nonzero(unknown))
    solved = factorise(matrix).solve(trust * mask[window][unknown] - rows @ held)
    opacity[window][unknown] = np.clip(solved, 0, 1)
    return opacity
