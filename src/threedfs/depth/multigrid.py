"""Multigrid for symmetric 5x5 stencils: the preconditioner of the depth solve.

A smoothness prior carries information across large regions without texture, where plain conjugate gradients
creep. Coarse grids (`galerkin.py`) carry it at once. The smoother is Chebyshev's of the fourth kind, which
needs no lower bound of the spectrum and is symmetric, so the cycle may precondition conjugate gradients.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from scipy.linalg import cho_factor, cho_solve

from threedfs.depth.bending import HALF_OFFSETS
from threedfs.depth.galerkin import BORDER, Level, flat_offsets


class Preconditioner:
    """A V-cycle for sum_k factor_k * hierarchy_k, in single precision."""

    def __init__(self, hierarchies: list[list[Level]], factors: list[float], smoothing_steps: int = 2) -> None:
        self._steps = smoothing_steps
        self._shapes = [level.shape for level in hierarchies[0]]
        self._planes, self._active, self._inverse_diagonal, self._radius, self._scratch = [], [], [], [], []
        for index, (height, width) in enumerate(self._shapes):
            levels = [hierarchy[index] for hierarchy in hierarchies]
            planes = np.zeros(levels[0].planes.shape, np.float32)
            for level, factor in zip(levels, factors, strict=True):
                for k in level.used:
                    planes[k] += (factor * level.planes[k]).astype(np.float32)
            others = np.array(sorted({k for level in levels for k in level.used} - {0}), np.int64)
            stride = width + 2 * BORDER
            self._planes.append(planes)
            self._active.append((others, flat_offsets(others, stride)))
            inverse, radius = _jacobi(planes, height, width, *self._active[-1])
            self._inverse_diagonal.append(inverse)
            self._radius.append(radius)
            self._scratch.append(np.zeros((4, planes.shape[1]), np.float32))
        self._coarsest = cho_factor(_dense(self._planes[-1].astype(np.float64), *self._shapes[-1]))

    def apply(self, residual: np.ndarray) -> np.ndarray:
        """Return an approximate solution for a flat bordered residual; symmetric and positive definite."""
        return self._cycle(0, residual.astype(np.float32)).astype(np.float64)

    def _cycle(self, index: int, right: np.ndarray) -> np.ndarray:
        height, width = self._shapes[index]
        if index == len(self._shapes) - 1:
            solution = np.zeros((height + 2 * BORDER, width + 2 * BORDER), np.float32)
            inner = right.reshape(solution.shape)[BORDER:-BORDER, BORDER:-BORDER].ravel().astype(np.float64)
            solution[BORDER:-BORDER, BORDER:-BORDER] = cho_solve(self._coarsest, inner).reshape(height, width)
            return solution.ravel()
        solution, residual, step, _ = self._scratch[index]
        solution[:] = 0
        self._smooth(index, solution, right, residual, step, start_at_zero=True)
        _residual(self._planes[index], solution, right, residual, height, width, *self._active[index])
        coarse_shape = self._shapes[index + 1]
        coarse = self._cycle(index + 1, _restrict(residual, height, width, *coarse_shape))
        _prolong_add(coarse, solution, height, width, coarse_shape[1])
        self._smooth(index, solution, right, residual, step, start_at_zero=False)
        return solution

    def _smooth(self, index, solution, right, residual, step, start_at_zero):
        height, width = self._shapes[index]
        for k in range(self._steps):
            if k == 0 and start_at_zero:
                residual[:] = right
            else:
                _residual(self._planes[index], solution, right, residual, height, width, *self._active[index])
            keep = np.float32((2 * k - 1) / (2 * k + 3)) if k else np.float32(0)
            rate = np.float32((8 * k + 4) / (2 * k + 3) / self._radius[index])
            _chebyshev_step(solution, step, residual, self._inverse_diagonal[index], keep, rate)


def _dense(planes: np.ndarray, height: int, width: int) -> np.ndarray:
    stride = width + 2 * BORDER
    matrix = np.zeros((planes.shape[1], planes.shape[1]))
    inner = (np.arange(height)[:, None] + BORDER) * stride + np.arange(width) + BORDER
    inner = inner.ravel()
    for k in range(13):
        offset = HALF_OFFSETS[k][0] * stride + HALF_OFFSETS[k][1]
        matrix[inner, inner + offset] += planes[k, inner]
        if k:
            matrix[inner + offset, inner] += planes[k, inner]
    matrix = matrix[np.ix_(inner, inner)]
    matrix[np.diag_indices_from(matrix)] *= 1 + 1e-10
    return matrix


@njit(cache=True)
def _jacobi(planes, height, width, active, offsets):
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
def _residual(planes, solution, right, residual, height, width, active, offsets):
    stride = width + 2 * BORDER
    for v in range(height):
        first = (v + BORDER) * stride + BORDER
        last = first + width
        out = residual[first:last]
        centre = planes[0, first:last]
        here = solution[first:last]
        given = right[first:last]
        for u in range(width):
            out[u] = given[u] - centre[u] * here[u]
        for n in range(len(active)):
            k = active[n]
            o = offsets[n]
            ahead = planes[k, first:last]
            behind = planes[k, first - o : last - o]
            x_ahead = solution[first + o : last + o]
            x_behind = solution[first - o : last - o]
            for u in range(width):
                out[u] -= ahead[u] * x_ahead[u] + behind[u] * x_behind[u]


@njit(cache=True)
def _chebyshev_step(solution, step, residual, inverse_diagonal, keep, rate):
    for i in range(len(solution)):
        step[i] = keep * step[i] + rate * inverse_diagonal[i] * residual[i]
        solution[i] += step[i]


@njit(cache=True)
def _restrict(residual, height, width, coarse_height, coarse_width):
    stride = width + 2 * BORDER
    coarse_stride = coarse_width + 2 * BORDER
    coarse = np.zeros((coarse_height + 2 * BORDER) * coarse_stride, np.float32)
    half, quarter = np.float32(0.5), np.float32(0.25)
    for v in range(coarse_height):
        for u in range(coarse_width):
            i = (2 * v + BORDER) * stride + 2 * u + BORDER
            sides = residual[i - 1] + residual[i + 1] + residual[i - stride] + residual[i + stride]
            above = residual[i - stride - 1] + residual[i - stride + 1]
            below = residual[i + stride - 1] + residual[i + stride + 1]
            coarse[(v + BORDER) * coarse_stride + u + BORDER] = residual[i] + half * sides + quarter * (above + below)
    return coarse


@njit(cache=True)
def _prolong_add(coarse, solution, height, width, coarse_width):
    stride = width + 2 * BORDER
    coarse_stride = coarse_width + 2 * BORDER
    half = np.float32(0.5)
    for v in range(height):
        for u in range(width):
            j = (v // 2 + BORDER) * coarse_stride + u // 2 + BORDER
            value = coarse[j] if u % 2 == 0 else half * (coarse[j] + coarse[j + 1])
            if v % 2 == 1:
                j += coarse_stride
                below = coarse[j] if u % 2 == 0 else half * (coarse[j] + coarse[j + 1])
                value = half * (value + below)
            solution[(v + BORDER) * stride + u + BORDER] += value
