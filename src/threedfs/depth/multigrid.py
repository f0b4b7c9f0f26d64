"""Multigrid for symmetric 5x5 stencils: the preconditioner of the depth solve.

A smoothness prior carries information across large regions without texture, where plain conjugate gradients
creep. Coarse grids carry it at once. Coarse matrices are Galerkin products with bilinear interpolation, so they
keep the edges and the confident pixels of the fine one; the smoother is Chebyshev's of the fourth kind, which
needs no lower bound of the spectrum and is symmetric, so the cycle may precondition conjugate gradients.

A level stores 13 planes, the half stencil of `bending.HALF_OFFSETS`, flat with a border of two zeros.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from scipy.linalg import cho_factor, cho_solve

from threedfs.depth.bending import HALF_OFFSETS, assemble_prior

BORDER = 2
_COARSEST = 24
_BENDING_RELIEF = 0.7
"""Factor of a second-order prior from one grid to the next coarser one: a bilinear surface bends only at the
coarse nodes, which makes its Galerkin product up to twice too stiff (0.5 without edges, more with many)."""
_OFFSETS = np.array(HALF_OFFSETS, np.int64)


@dataclass(frozen=True)
class Level:
    """One grid of a hierarchy: `planes` (13, (H + 4) (W + 4)) and the inner shape (H, W)."""

    planes: np.ndarray
    shape: tuple[int, int]


def padded_shape(shape: tuple[int, int]) -> tuple[int, int]:
    """Return the least shape not under `shape` of m 2^k + 1 on each axis: every coarse border is a fine one."""
    halvings = 0
    while min(shape) > _COARSEST << halvings:
        halvings += 1
    step = 1 << halvings
    return tuple(int(-(-(n - 1) // step) * step + 1) for n in shape)


def coarsen_prior(weight: np.ndarray, prior: str) -> list[Level]:
    """Assemble a smoothness prior (see `assemble_prior`) on a padded shape and coarsen it, fine first."""
    return _coarsen(assemble_prior(weight, prior), 1.0 if prior == "first_order" else _BENDING_RELIEF)


def coarsen_diagonal(diagonal: np.ndarray) -> list[Level]:
    """Coarsen a diagonal matrix (H, W) of a padded shape by Galerkin products, fine first."""
    planes = np.zeros((13, *diagonal.shape))
    planes[0] = diagonal
    return _coarsen(planes, 1.0)


def _coarsen(planes: np.ndarray, factor: float) -> list[Level]:
    levels = [_lay_out(planes)]
    while min(levels[-1].shape) > _COARSEST + 1:
        fine = levels[-1]
        shape = ((fine.shape[0] + 1) // 2, (fine.shape[1] + 1) // 2)
        active = np.flatnonzero([plane.any() for plane in fine.planes])
        levels.append(Level(factor * _galerkin(fine.planes, *fine.shape, *shape, _OFFSETS, active), shape))
    return levels


def _lay_out(planes: np.ndarray) -> Level:
    height, width = planes.shape[1:]
    bordered = np.zeros((13, height + 2 * BORDER, width + 2 * BORDER))
    bordered[:, BORDER:-BORDER, BORDER:-BORDER] = planes
    return Level(bordered.reshape(13, -1), (height, width))


class Preconditioner:
    """A V-cycle for sum_k factor_k * hierarchy_k, in single precision."""

    def __init__(self, hierarchies: list[list[Level]], factors: list[float], smoothing_steps: int = 2) -> None:
        self._steps = smoothing_steps
        self._shapes = [level.shape for level in hierarchies[0]]
        self._planes, self._active, self._inverse_diagonal, self._radius, self._scratch = [], [], [], [], []
        for index, (height, width) in enumerate(self._shapes):
            active = np.flatnonzero([any(h[index].planes[k].any() for h in hierarchies) for k in range(13)])
            planes = np.zeros_like(hierarchies[0][index].planes, np.float32)
            for k in active:
                for hierarchy, factor in zip(hierarchies, factors, strict=True):
                    planes[k] += (factor * hierarchy[index].planes[k]).astype(np.float32)
            stride = width + 2 * BORDER
            self._planes.append(planes)
            self._active.append((active[active > 0], flat_offsets(active[active > 0], stride)))
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


def flat_offsets(active: np.ndarray, stride: int) -> np.ndarray:
    """Return the steps of the given planes in a flat bordered array with rows of `stride`."""
    return _OFFSETS[active, 0] * stride + _OFFSETS[active, 1]


def _dense(planes: np.ndarray, height: int, width: int) -> np.ndarray:
    stride = width + 2 * BORDER
    matrix = np.zeros((planes.shape[1], planes.shape[1]))
    inner = (np.arange(height)[:, None] + BORDER) * stride + np.arange(width) + BORDER
    inner = inner.ravel()
    for k in range(13):
        offset = _OFFSETS[k, 0] * stride + _OFFSETS[k, 1]
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


@njit(cache=True)
def _galerkin(fine, height, width, coarse_height, coarse_width, offsets, active):
    stride = width + 2 * BORDER
    coarse_stride = coarse_width + 2 * BORDER
    coarse = np.zeros((13, (coarse_height + 2 * BORDER) * coarse_stride))
    plane_of = np.full((3, 5), -1)
    for k in range(13):
        plane_of[offsets[k, 0], offsets[k, 1] + 2] = k
    for cv in range(coarse_height):
        for cu in range(coarse_width):
            target = (cv + BORDER) * coarse_stride + cu + BORDER
            for dv in range(-1, 2):
                for du in range(-1, 2):
                    v, u = 2 * cv + dv, 2 * cu + du
                    if v < 0 or v >= height or u < 0 or u >= width:
                        continue
                    i = (v + BORDER) * stride + u + BORDER
                    weight = (1.0 - 0.5 * abs(dv)) * (1.0 - 0.5 * abs(du))
                    for k in active:
                        for side in range(2):
                            if k == 0 and side == 1:
                                continue
                            sign = 1 - 2 * side
                            ov, ou = sign * offsets[k, 0], sign * offsets[k, 1]
                            value = fine[k, i] if side == 0 else fine[k, i + ov * stride + ou]
                            if value == 0:
                                continue
                            value *= weight
                            jv, ju = v + ov, u + ou
                            for pv in range(jv // 2, (jv + 1) // 2 + 1):
                                for pu in range(ju // 2, (ju + 1) // 2 + 1):
                                    rv, ru = pv - cv, pu - cu
                                    if rv < 0 or (rv == 0 and ru < 0):
                                        continue
                                    share = (0.5 if jv % 2 else 1.0) * (0.5 if ju % 2 else 1.0)
                                    coarse[plane_of[rv, ru + 2], target] += value * share
    return coarse
