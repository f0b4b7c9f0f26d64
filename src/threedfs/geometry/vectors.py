"""Rows of vectors: products without the cost of reducing along a short axis."""

from __future__ import annotations

import numpy as np


def dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return the inner products (N,) of rows (N, 3)."""
    return np.einsum("ij,ij->i", a, b)


def normalise(vectors: np.ndarray) -> np.ndarray:
    """Return rows (N, 3) scaled to length 1; zero rows stay zero."""
    length = np.sqrt(dot(vectors, vectors))
    return vectors / np.maximum(length, 1e-300)[:, None]
