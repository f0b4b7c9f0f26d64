"""Density of a Gaussian mixture of colours."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit


@dataclass(frozen=True)
class Mixture:
    """A Gaussian mixture of colours, of full covariances.

    Attributes
    ----------
    weights : (K,) float64
    means : (K, 3) float64
        Lab.
    precisions_cholesky : (K, 3, 3) float64
        Upper triangular factors of the inverse covariances: each is a factor times its transpose.
    """

    weights: np.ndarray
    means: np.ndarray
    precisions_cholesky: np.ndarray


def log_density(mixture: Mixture, lab: np.ndarray) -> np.ndarray:
    """Return the logarithm of a mixture's density at colours.

    Parameters
    ----------
    mixture : Mixture
    lab : (N, 3) float32 or float64

    Returns
    -------
    (N,) float64
    """
    factors = mixture.precisions_cholesky
    scale = np.log(np.diagonal(factors, axis1=1, axis2=2)).sum(axis=1) - 1.5 * np.log(2 * np.pi)
    offsets = np.log(np.maximum(mixture.weights, 1e-300)) + scale
    return _sum_components(np.ascontiguousarray(lab), mixture.means, np.ascontiguousarray(factors), offsets)


@njit(nogil=True, cache=True)
def _sum_components(lab, means, factors, offsets):
    """Return log sum exp over components of offset - |(color - mean) factor|^2 / 2; factors are upper triangular."""
    result = np.empty(len(lab))
    terms = np.empty(len(offsets))
    for sample in range(len(lab)):
        largest = -np.inf
        for k in range(len(offsets)):
            x = lab[sample, 0] - means[k, 0]
            y = lab[sample, 1] - means[k, 1]
            z = lab[sample, 2] - means[k, 2]
            a = x * factors[k, 0, 0]
            b = x * factors[k, 0, 1] + y * factors[k, 1, 1]
            c = x * factors[k, 0, 2] + y * factors[k, 1, 2] + z * factors[k, 2, 2]
            terms[k] = offsets[k] - (a * a + b * b + c * c) / 2
            largest = max(largest, terms[k])
        total = 0.0
        for k in range(len(offsets)):
            apart = terms[k] - largest
            if apart > -40:
                total += np.exp(apart)
        result[sample] = largest + np.log(total)
    return result
