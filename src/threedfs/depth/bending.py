"""Smoothness priors: squared differences of the depth, and the stencils of their normal equations (Eq. 3).

A prior is a sum over pixels of weight(u) times squared finite differences. Its matrix is symmetric and couples
a pixel with those at most two steps away, so half of a 13-point stencil stores it.
"""

from __future__ import annotations

import numpy as np
from numba import njit

PRIORS = ("first_order", "second_order", "rotation_invariant")

HALF_OFFSETS = (
    (0, 0),
    (0, 1),
    (0, 2),
    (1, -2),
    (1, -1),
    (1, 0),
    (1, 1),
    (1, 2),
    (2, -2),
    (2, -1),
    (2, 0),
    (2, 1),
    (2, 2),
)
"""(row, column) steps whose coefficients are stored; those of the opposite steps follow by symmetry."""

STENCILS = {
    "first_order": (0, 1, 5),
    "second_order": (0, 1, 2, 5, 10),
    "rotation_invariant": (0, 1, 2, 4, 5, 6, 10),
}
"""Which of `HALF_OFFSETS` a prior couples a pixel with."""

_ORDER = {"first_order": 1, "second_order": 2, "rotation_invariant": 3}


def assemble_prior(weight: np.ndarray, prior: str, border: int = 0) -> np.ndarray:
    """Assemble the half stencil of a smoothness prior, one plane for each of its coefficients.

    Parameters
    ----------
    weight : (H, W) float64
        Weight of the energy at each pixel (the part of lambda_s that does not change with iterations).
    prior : {"first_order", "second_order", "rotation_invariant"}
        Squared gradient; squared second derivatives along the axes; these and twice the squared mixed
        derivative, the bending energy that an in-plane rotation of the camera leaves unchanged (Eq. 3).
    border : int
        So many rows and columns of zeros are left on each side.

    Differs from the paper, whose lambda_s(u) is one weight a pixel: differences between pixel centres (gradients, the
    mixed derivative) take the least weight of their pixels, so that an edge one pixel wide cuts them too.

    Returns
    -------
    (13, H + 2 border, W + 2 border) float64
        Coefficients in the order of `HALF_OFFSETS` of the matrix whose quadratic form is the energy.
    """
    height, width = weight.shape
    planes = np.zeros((len(HALF_OFFSETS), height + 2 * border, width + 2 * border))
    inner = planes[:, border : border + height, border : border + width]
    _assemble(np.ascontiguousarray(weight, np.float64), _ORDER[prior], inner)
    return planes


def release_bends(depth: np.ndarray, tolerated: float, prior: str) -> np.ndarray:
    """Weaken a prior where the surface already bends more than smooth surfaces do: at depth discontinuities.

    Beyond the paper, which relies on image edges alone: a step that shows no edge in the image would be bridged.
    The factor 1 / (1 + (b / tolerated)^2) is that of Geman and McClure's robust energy for iteratively reweighted
    least squares.

    Parameters
    ----------
    depth : (H, W) float64
    tolerated : float
        Difference per pixel (or of differences, for second-order priors) relative to depth that halves the weight.
    prior : str

    Returns
    -------
    (H, W) float64 in (0, 1]
    """
    relative = np.pad(np.log(np.maximum(depth, 1e-6)), 1, mode="edge")
    centre = relative[1:-1, 1:-1]
    if prior == "first_order":
        energy = ((relative[1:-1, 2:] - relative[1:-1, :-2]) / 2) ** 2
        energy += ((relative[2:, 1:-1] - relative[:-2, 1:-1]) / 2) ** 2
    else:
        energy = (relative[1:-1, 2:] - 2 * centre + relative[1:-1, :-2]) ** 2
        energy += (relative[2:, 1:-1] - 2 * centre + relative[:-2, 1:-1]) ** 2
        energy[[0, -1]] = 0
        energy[:, [0, -1]] = 0
    return 1 / (1 + energy / tolerated**2)


@njit(cache=True)
def _assemble(weight, order, planes):
    height, width = weight.shape
    for v in range(height):
        for u in range(width):
            if order == 1:
                if u + 1 < width:
                    w = min(weight[v, u], weight[v, u + 1])
                    planes[0, v, u] += w
                    planes[0, v, u + 1] += w
                    planes[1, v, u] -= w
                if v + 1 < height:
                    w = min(weight[v, u], weight[v + 1, u])
                    planes[0, v, u] += w
                    planes[0, v + 1, u] += w
                    planes[5, v, u] -= w
                continue
            w = weight[v, u]
            if 0 < u < width - 1:
                planes[0, v, u - 1] += w
                planes[0, v, u] += 4 * w
                planes[0, v, u + 1] += w
                planes[1, v, u - 1] -= 2 * w
                planes[1, v, u] -= 2 * w
                planes[2, v, u - 1] += w
            if 0 < v < height - 1:
                planes[0, v - 1, u] += w
                planes[0, v, u] += 4 * w
                planes[0, v + 1, u] += w
                planes[5, v - 1, u] -= 2 * w
                planes[5, v, u] -= 2 * w
                planes[10, v - 1, u] += w
            if order == 3 and u + 1 < width and v + 1 < height:
                w = 2 * min(min(weight[v, u], weight[v, u + 1]), min(weight[v + 1, u], weight[v + 1, u + 1]))
                planes[0, v, u] += w
                planes[0, v, u + 1] += w
                planes[0, v + 1, u] += w
                planes[0, v + 1, u + 1] += w
                planes[1, v, u] -= w
                planes[1, v + 1, u] -= w
                planes[5, v, u] -= w
                planes[5, v, u + 1] -= w
                planes[6, v, u] += w
                planes[4, v, u + 1] += w
