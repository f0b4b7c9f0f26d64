"""Which matting components are the object's, by what a trimap knows."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from threedfs.matting.trimap import Trimap

_AT_ONCE = 2**16
"""Sets of components whose cost is found together."""


def assign_components(components: np.ndarray, laplacian: sparse.csr_array, trimap: Trimap) -> np.ndarray:
    """Return which components (K,) bool add up to the object's opacity.

    Of all 2^K sets it is the one of least cost: x^T L x of its opacity x, as in Section 6 of Levin, Rav-Acha and
    Lischinski 2008, and the squared distance of x from what is known, summed over the known pixels. Object and
    background count the same, however many pixels are known of each.

    Parameters
    ----------
    components : (N, K) float64
    laplacian : (N, N) float64
    trimap : Trimap
        Of N pixels, object and background among them.
    """
    inner, outside = trimap.inner.reshape(-1), ~trimap.outer.reshape(-1)
    known = inner.sum() + outside.sum()
    count = components.shape[1]
    quadratic = components.T @ (laplacian @ components)
    linear = np.zeros(count)
    for pixels, value in ((inner, 1.0), (outside, 0.0)):
        here, weight = components[pixels], known / (2 * pixels.sum())
        quadratic = quadratic + weight * here.T @ here
        linear += weight * value * here.sum(axis=0)
    best, least = np.zeros(count, bool), np.inf
    for start in range(0, 2**count, _AT_ONCE):
        number = np.arange(start, min(start + _AT_ONCE, 2**count))
        chosen = (number[:, None] >> np.arange(count) & 1).astype(np.float64)
        cost = ((chosen @ quadratic - 2 * linear) * chosen).sum(axis=1)
        if cost.min() < least:
            best, least = chosen[cost.argmin()] > 0, cost.min()
    return best
