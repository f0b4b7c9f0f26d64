"""Multigrid for symmetric 5x5 stencils: the preconditioner of the depth solve.

A smoothness prior carries information across large regions without texture, where plain conjugate gradients
creep. Coarse grids (`galerkin.py`) carry it at once. The smoother is Chebyshev's of the fourth kind, which
needs no lower bound of the spectrum and is symmetric, so the cycle may precondition conjugate gradients.

Coefficients are most of the data. Each half of a cycle reads them once: what follows on a row (another smoothing
step, the residual, its restriction) is done as soon as the rows that it needs are, while they are cached.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from scipy.linalg import cho_solve_banded, cholesky_banded

from threedfs.depth.bending import HALF_OFFSETS
from threedfs.depth.galerkin import BORDER, Level, flat_offsets

_VISITS = 2
"""Times that a grid is visited from the next finer one, if it is one of the first coarse ones: the second visit mends
what bilinear interpolation does to a bending energy, and spares two of three steps of conjugate gradients."""
_REVISITED = 2
"""So many coarse grids are visited more than once."""

# Two steps of fourth-kind Chebyshev smoothing: what is kept of the step before, and rates times the spectral radius.
_FIRST_RATE = 4 / 3
_KEPT = np.float32(1 / 5)
_SECOND_RATE = 12 / 5


class Preconditioner:
    """A cycle for sum_k factor_k * hierarchy_k, in single precision: W over the first coarse grids, V below."""

    def __init__(self, hierarchies: list[list[Level]], factors: list[float]) -> None:
        self._shapes = [level.shape for level in hierarchies[0]]
        self._matrices, self._smoothers, self._scratch = [], [], []
        for index, (height, width) in enumerate(self._shapes):
            levels = [hierarchy[index] for hierarchy in hierarchies]
            planes = np.zeros(levels[0].planes.shape, np.float32)
            for level, factor in zip(levels, factors, strict=True):
                for k in level.used:
                    _add_scaled(planes[k], level.planes[k], factor)
            others = np.array(sorted({k for level in levels for k in level.used} - {0}), np.int64)
            matrix = planes, others, flat_offsets(others, width + 2 * BORDER)
            inverse, radius = _jacobi(*matrix, height, width)
            self._matrices.append(matrix)
            self._smoothers.append((inverse, np.float32(_FIRST_RATE / radius), np.float32(_SECOND_RATE / radius)))
            self._scratch.append(np.zeros((6, planes.shape[1]), np.float32))
        self._coarsest = cholesky_banded(_lower_bands(self._matrices[-1][0], *self._shapes[-1]), lower=True)

    def apply(self, residual: np.ndarray) -> np.ndarray:
        """Return an approximate solution for a flat bordered residual; symmetric and positive definite.

        It is float32, and overwritten by the next call.
        """
        right = self._scratch[0][3]
        right[:] = residual
        return self._cycle(0, right)

    def _cycle(self, index: int, right: np.ndarray) -> np.ndarray:
        height, width = self._shapes[index]
        solution, step, residual = self._scratch[index][:3]
        if index == len(self._shapes) - 1:
            inner = _inside(right, height).ravel().astype(np.float64)
            exact = cho_solve_banded((self._coarsest, True), inner, overwrite_b=True, check_finite=False)
            _inside(solution, height)[:] = exact.reshape(height, width)
            return solution
        grid = *self._matrices[index], *self._smoothers[index]
        coarse_height, coarse_width = self._shapes[index + 1]
        coarse_right = self._scratch[index + 1][3]
        _descend(*grid, right, step, solution, residual, coarse_right, height, width, coarse_height, coarse_width)
        coarse = self._cycle(index + 1, coarse_right)
        if index < _REVISITED:
            total, rest = self._scratch[index + 1][4:]
            for _ in range(_VISITS - 1):
                total[:] = coarse
                _subtract_product(*self._matrices[index + 1], total, coarse_right, rest, coarse_height, coarse_width)
                coarse = self._cycle(index + 1, rest)
                coarse += total
        _ascend(*grid, right, coarse, step, solution, residual, height, width, coarse_width)
        return solution


def _inside(flat: np.ndarray, height: int) -> np.ndarray:
    """View a flat bordered array as (H, W), without its border."""
    return flat.reshape(height + 2 * BORDER, -1)[BORDER:-BORDER, BORDER:-BORDER]


def _lower_bands(planes: np.ndarray, height: int, width: int) -> np.ndarray:
    """Return the diagonals (2 W + 3, H W) float64, main one first, of the matrix over the rows of a grid."""
    bands = np.zeros((2 * width + 3, height * width))
    column = np.arange(width)
    for (down, right), plane in zip(HALF_OFFSETS, planes, strict=True):
        coupled = _inside(plane, height)[: max(height - down, 0)] * ((column + right >= 0) & (column + right < width))
        bands[down * width + right, : coupled.size] += coupled.ravel()
    bands[0] *= 1 + 1e-10
    return bands


@njit(cache=True)
def _jacobi(planes, active, offsets, height, width):
    """Inverse diagonal, and Gershgorin's bound of the spectral radius of the diagonally scaled matrix."""
    stride = width + 2 * BORDER
    inverse = np.zeros(planes.shape[1], np.float32)
    radius = np.float32(1)
    for v in range(height):
        for u in range(width):
            i = (v + BORDER) * stride + u + BORDER
            diagonal = planes[0, i]
            total = diagonal
            for n in range(len(active)):
                k = active[n]
                total += abs(planes[k, i]) + abs(planes[k, i - offsets[n]])
            if diagonal > 0:
                inverse[i] = 1 / diagonal
                radius = max(radius, total / diagonal)
    return inverse, radius


@njit(cache=True)
def _add_scaled(out, plane, factor):
    for i in range(len(out)):
        out[i] += np.float32(factor * plane[i])


@njit(cache=True)
def _subtract_row(planes, active, offsets, x, right, first, width, out):
    """Fill `out`, a row without its border, with `right` less the product with `x`.

    Planes are taken two at a time, for speed: all stencils couple a pixel with an even number of steps.
    """
    last = first + width
    centre = planes[0, first:last]
    here = x[first:last]
    given = right[first:last]
    for u in range(width):
        out[u] = given[u] - centre[u] * here[u]
    for n in range(0, len(active) - 1, 2):
        k, j, o, p = active[n], active[n + 1], offsets[n], offsets[n + 1]
        ahead1, behind1 = planes[k, first:last], planes[k, first - o : last - o]
        ahead2, behind2 = planes[j, first:last], planes[j, first - p : last - p]
        x_ahead1, x_behind1 = x[first + o : last + o], x[first - o : last - o]
        x_ahead2, x_behind2 = x[first + p : last + p], x[first - p : last - p]
        for u in range(width):
            one = ahead1[u] * x_ahead1[u] + behind1[u] * x_behind1[u]
            out[u] -= one + (ahead2[u] * x_ahead2[u] + behind2[u] * x_behind2[u])


@njit(cache=True)
def _subtract_product(planes, active, offsets, x, right, out, height, width):
    stride = width + 2 * BORDER
    for v in range(height):
        first = (v + BORDER) * stride + BORDER
        _subtract_row(planes, active, offsets, x, right, first, width, out[first : first + width])


@njit(cache=True)
def _descend(
    planes, active, offsets, inverse, rate1, rate2, right, step, solution, residual, coarse, height, width,
    coarse_height, coarse_width,
):  # fmt: skip
    """Smooth twice from zero into `solution`, and restrict the residual into `coarse`."""
    stride = width + 2 * BORDER
    for v in range(height + 5):
        if v < height:
            first = (v + BORDER) * stride + BORDER
            last = first + width
            _scale_row(rate1, inverse[first:last], right[first:last], step[first:last])
        if 2 <= v < height + 2:
            first = (v - 2 + BORDER) * stride + BORDER
            last = first + width
            row = residual[first:last]
            _subtract_row(planes, active, offsets, step, right, first, width, row)
            out, before, scale = solution[first:last], step[first:last], inverse[first:last]
            for u in range(width):
                out[u] = before[u] + (_KEPT * before[u] + rate2 * scale[u] * row[u])
        if 4 <= v < height + 4:
            first = (v - 4 + BORDER) * stride + BORDER
            _subtract_row(planes, active, offsets, solution, right, first, width, residual[first : first + width])
        if v >= 5 and v % 2 == 1 and (v - 5) // 2 < coarse_height:
            _restrict_row(residual, (v - 5) // 2, stride, coarse, coarse_width)


@njit(cache=True)
def _scale_row(rate, scale, values, out):
    for u in range(len(out)):
        out[u] = rate * scale[u] * values[u]


@njit(cache=True)
def _restrict_row(residual, v, stride, coarse, coarse_width):
    half, quarter = np.float32(0.5), np.float32(0.25)
    first = (v + BORDER) * (coarse_width + 2 * BORDER) + BORDER
    out = coarse[first : first + coarse_width]
    start = (2 * v + BORDER) * stride + BORDER - 1
    length = 2 * coarse_width + 1
    above = residual[start - stride : start - stride + length]
    here = residual[start : start + length]
    below = residual[start + stride : start + stride + length]
    for u in range(coarse_width):
        sides = here[2 * u] + here[2 * u + 2] + above[2 * u + 1] + below[2 * u + 1]
        corners = above[2 * u] + above[2 * u + 2] + (below[2 * u] + below[2 * u + 2])
        out[u] = here[2 * u + 1] + half * sides + quarter * corners


@njit(cache=True)
def _ascend(
    planes, active, offsets, inverse, rate1, rate2, right, coarse, step, solution, residual, height, width,
    coarse_width,
):  # fmt: skip
    """Add the interpolated coarse solution to `solution` and smooth twice, in place."""
    stride = width + 2 * BORDER
    for v in range(height + 8):
        if v < height:
            _prolong_row(coarse, v, solution, width, coarse_width)
        if 2 <= v < height + 2:
            first = (v - 2 + BORDER) * stride + BORDER
            last = first + width
            row = residual[first:last]
            _subtract_row(planes, active, offsets, solution, right, first, width, row)
            _scale_row(rate1, inverse[first:last], row, step[first:last])
        # A row may change once the rows two below it have been read around: not before.
        if 4 <= v < height + 4:
            first = (v - 4 + BORDER) * stride + BORDER
            _add_row(step[first : first + width], solution[first : first + width])
        if 6 <= v < height + 6:
            first = (v - 6 + BORDER) * stride + BORDER
            last = first + width
            row = residual[first:last]
            _subtract_row(planes, active, offsets, solution, right, first, width, row)
            out, scale = step[first:last], inverse[first:last]
            for u in range(width):
                out[u] = _KEPT * out[u] + rate2 * scale[u] * row[u]
        if v >= 8:
            first = (v - 8 + BORDER) * stride + BORDER
            _add_row(step[first : first + width], solution[first : first + width])


@njit(cache=True)
def _add_row(values, out):
    for u in range(len(out)):
        out[u] += values[u]


@njit(cache=True)
def _prolong_row(coarse, v, solution, width, coarse_width):
    coarse_stride = coarse_width + 2 * BORDER
    half = np.float32(0.5)
    start = (v // 2 + BORDER) * coarse_stride + BORDER
    above = coarse[start : start + coarse_width + 1]
    start += (v % 2) * coarse_stride
    below = coarse[start : start + coarse_width + 1]
    first = (v + BORDER) * (width + 2 * BORDER) + BORDER
    out = solution[first : first + width]
    for u in range(width // 2):
        left = half * (above[u] + below[u])
        right = half * (above[u + 1] + below[u + 1])
        out[2 * u] += left
        out[2 * u + 1] += half * (left + right)
    if width % 2:
        out[width - 1] += half * (above[width // 2] + below[width // 2])
