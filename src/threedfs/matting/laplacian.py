"""The matting Laplacian: how well an opacity is a linear function of colour within every small window."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import SuperLU, splu

_SIDE = 3
"""Pixels along a window."""
_AT_ONCE = 20_000
"""Windows whose entries are made together: 81 of each."""


def matting_laplacian(image: np.ndarray, epsilon: float, within: np.ndarray | None = None) -> sparse.csr_array:
    """Return the matting Laplacian of an image (Levin, Lischinski, Weiss 2008, Eq. 12).

    Over windows of 3 x 3 pixels, each adds to a pair of its pixels i, j

        delta_ij - (1 + (I_i - mean)^T (covariance + epsilon / 9)^-1 (I_j - mean)) / 9.

    So x^T L x tells how far x is from a linear function of colour in all windows. The matrix is symmetric and positive
    semi-definite, and its rows sum to zero.

    Parameters
    ----------
    image : (H, W, 3) uint8
        RGB. Colours count from 0 to 1.
    epsilon : float
        Holds back slopes over colours that hardly differ. With 0, a window of one colour has no inverse.
    within : (H, W) bool, optional
        Only windows that hold one of these pixels are built: the rows of these pixels are complete, others are not.

    Returns
    -------
    (H W, H W) float64
        Pixels row by row.
    """
    rows, columns = image.shape[:2]
    number = np.arange(rows * columns, dtype=np.int32).reshape(rows, columns)
    windows = np.lib.stride_tricks.sliding_window_view(number, (_SIDE, _SIDE)).reshape(-1, _SIDE**2)
    if within is not None:
        windows = windows[within.reshape(-1)[windows].any(axis=1)]
    colors = image.reshape(-1, 3) / 255.0
    size = (rows * columns, rows * columns)
    total = sparse.csr_array(size, dtype=np.float64)
    for start in range(0, len(windows), _AT_ONCE):
        pixels = windows[start : start + _AT_ONCE]
        entries = _window_entries(colors[pixels], epsilon)
        first, second = np.broadcast_arrays(pixels[:, :, None], pixels[:, None, :])
        total = total + sparse.coo_array((entries.reshape(-1), (first.reshape(-1), second.reshape(-1))), size).tocsr()
    return ((total + total.T) / 2).tocsr()  # sums were taken in another order on the other side of the diagonal


def factorise(matrix: sparse.sparray) -> SuperLU:
    """Return the factors of a symmetric matrix (N, N) of pixels, whose `solve` takes a right-hand side (N,)."""
    return splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})


def _window_entries(colors: np.ndarray, epsilon: float) -> np.ndarray:
    """Return the matrix (count, 9, 9) of each window from its pixels' colours (count, 9, 3)."""
    area = colors.shape[1]
    apart = colors - colors.mean(axis=1, keepdims=True)
    covariance = apart.transpose(0, 2, 1) @ apart / area
    slopes = np.linalg.solve(covariance + epsilon / area * np.eye(3), apart.transpose(0, 2, 1))
    return np.eye(area) - (1 + apart @ slopes) / area
