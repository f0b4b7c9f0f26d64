"""Weighted ridge regression (Section 3.3.2, Eq. 18)."""

from __future__ import annotations

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from threedfs.deform.rbf import PlacedBasis


def fit_ridge(basis: PlacedBasis, target: np.ndarray, weight: np.ndarray, ridge: float) -> np.ndarray:
    """Minimise sum_i weight_i (basis_i a - target_i)^2 + ridge |a|^2 / 2 over the coefficients a.

    Parameters
    ----------
    basis : PlacedBasis
        C functions at N points.
    target : (N,) float64
    weight : (N,) float64, not negative
    ridge : float
        Above 0.

    Returns
    -------
    (C,) float64
    """
    matrix = np.zeros((len(basis.centres), len(basis.centres)))
    right = np.zeros(len(basis.centres))
    for rows, columns, block in basis.blocks():
        weighted = block * weight[rows, None]
        matrix[np.ix_(columns, columns)] += weighted.T @ block
        right[columns] += target[rows] @ weighted
    matrix[np.diag_indices_from(matrix)] += ridge / 2
    return cho_solve(cho_factor(matrix.T, overwrite_a=True), right)  # in Fortran's order: no copy
