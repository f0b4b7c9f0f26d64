"""Weighted ridge regression (Section 3.3.2, Eq. 18)."""

from __future__ import annotations

import numpy as np
from scipy.linalg import cho_factor, cho_solve


def fit_ridge(basis: np.ndarray, target: np.ndarray, weight: np.ndarray, ridge: float) -> np.ndarray:
    """Minimise sum_i weight_i (basis_i a - target_i)^2 + ridge |a|^2 / 2 over the coefficients a.

    Solved in the smaller of the two spaces, rows or coefficients.

    Parameters
    ----------
    basis : (N, C) float64
    target : (N,) float64
    weight : (N,) float64, not negative
    ridge : float
        Above 0.

    Returns
    -------
    (C,) float64
    """
    root = np.sqrt(weight)
    rows, right = basis * root[:, None], target * root
    if len(rows) < basis.shape[1]:
        return rows.T @ _solve(rows @ rows.T, right, ridge)
    return _solve(rows.T @ rows, rows.T @ right, ridge)


def _solve(matrix: np.ndarray, right: np.ndarray, ridge: float) -> np.ndarray:
    matrix[np.diag_indices_from(matrix)] += ridge / 2
    return cho_solve(cho_factor(matrix, overwrite_a=True), right)
