"""Step 2: the smooth surface nearest to measurements and photo-consistent depths (Section 3.2, Eq. 8)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numba import njit

from threedfs.depth.galerkin import BORDER, Level, coarsen_diagonal, coarsen_prior, flat_offsets, padded_shape
from threedfs.depth.multigrid import Preconditioner
from threedfs.errors import UserError

_PADDING_WEIGHT = 1e-4
"""Smoothness of the rows and columns that only fill the grid up: enough to be solvable, too little to pull."""


@dataclass(frozen=True)
class SurfaceProblem:
    """The part of Eq. 8 that does not change with the iterations.

    The matrix is measurement + coupling_factor * confidence + smoothness * prior, the first two diagonal.
    """

    shape: tuple[int, int]
    padded: tuple[int, int]
    prior: list[Level]
    confidence: list[Level]
    measurement: list[Level]


@dataclass(frozen=True)
class Solution:
    """A solved surface: `depth` (H, W) float64, the estimated relative energy-norm error, and the steps it took."""

    depth: np.ndarray
    residual: float
    steps: int


def pose_problem(
    edge_weight: np.ndarray, confidence: np.ndarray, measurement_weight: np.ndarray, prior: str
) -> SurfaceProblem:
    """Assemble the three matrices of Eq. 8 on all grids.

    Parameters
    ----------
    edge_weight : (H, W) float64
        The spatial factor of the smoothness weight (Eq. 9).
    confidence : (H, W) float64
        lambda_a (Eq. 11); 0 where no depth was searched.
    measurement_weight : (H, W) float64
        lambda_m; 0 where nothing was measured.
    prior : str
        See `assemble_prior`.
    """
    shape = edge_weight.shape
    padded = padded_shape(shape)
    return SurfaceProblem(
        shape,
        padded,
        coarsen_prior(_pad(edge_weight, padded, _PADDING_WEIGHT), prior),
        coarsen_diagonal(_pad(confidence, padded, 0.0)),
        coarsen_diagonal(_pad(measurement_weight, padded, 0.0)),
    )


def replace_prior(problem: SurfaceProblem, weight: np.ndarray, prior: str) -> SurfaceProblem:
    """Return the problem with another spatial smoothness weight (H, W)."""
    return replace(problem, prior=coarsen_prior(_pad(weight, problem.padded, _PADDING_WEIGHT), prior))


def solve_surface(
    problem: SurfaceProblem,
    auxiliary_depth: np.ndarray,
    measured_depth: np.ndarray,
    start: np.ndarray,
    *,
    coupling_factor: float,
    smoothness: float,
    tolerance: float,
    max_steps: int,
) -> Solution:
    """Minimise Eq. 8 by conjugate gradients, preconditioned by multigrid, warm-started.

    Parameters
    ----------
    auxiliary_depth, measured_depth, start : (H, W) float64
        Values are read only where their weight is positive.
    coupling_factor : float
        1 / (2 theta).
    smoothness : float
        The factor of the smoothness weight that grows with the iterations.
    tolerance : float
        Stop when the energy norm of the error, estimated through the preconditioner, is below this share of the
        energy norm of the right-hand side. A residual relative to the largest weight would mean nothing.
    max_steps : int

    Raises
    ------
    UserError
        If no pixel has a confident depth or a measurement: nothing says where the surface is.
    """
    confidence, measurement = problem.confidence[0].planes[0], problem.measurement[0].planes[0]
    diagonal = coupling_factor * confidence + measurement
    if not diagonal.max() > 0:
        raise UserError(
            "depth: expected pixels with a photo-consistent or measured depth, found none; the image has no texture, "
            "or no neighbour overlaps it."
        )
    planes = problem.prior[0].planes
    height, width = problem.padded
    active = np.array(problem.prior[0].used[1:], np.int64)
    offsets = flat_offsets(active, width + 2 * BORDER)

    matrix = planes, active, offsets, diagonal, smoothness

    right = coupling_factor * confidence * _flatten(auxiliary_depth, problem.padded, confidence > 0)
    right += measurement * _flatten(measured_depth, problem.padded, measurement > 0)
    preconditioner = Preconditioner(
        [problem.prior, problem.confidence, problem.measurement], [smoothness, coupling_factor, 1.0]
    )
    solution = _flatten(start, problem.padded)
    direction, product = np.zeros_like(right), np.zeros_like(right)
    _direct(*matrix, solution, 0.0, direction, product, height, width)
    residual = right - product
    scale = _two_products(right, right, preconditioner.apply(right))[0] or 1.0
    energy_before, length = 1.0, 0.0
    error = np.inf
    for step in range(max_steps + 1):
        preconditioned = preconditioner.apply(residual)
        energy, overlap = _two_products(residual, product, preconditioned)
        error = np.sqrt(max(energy, 0.0) / scale)
        if error <= tolerance or step == max_steps:
            break
        # Polak and Ribiere's factor forgives the rounding of a single-precision preconditioner: the product of the
        # new direction with the change of the residual, -length * product.
        factor = max(-length * overlap / energy_before, 0.0) if step else 0.0
        length = energy / _direct(*matrix, preconditioned, factor, direction, product, height, width)
        _advance(length, direction, product, solution, residual)
        energy_before = energy
    inner = solution.reshape(height + 2 * BORDER, -1)[
        BORDER : BORDER + problem.shape[0], BORDER : BORDER + problem.shape[1]
    ]
    return Solution(inner.copy(), float(error), step)


def _pad(image: np.ndarray, padded: tuple[int, int], value: float) -> np.ndarray:
    rows, columns = padded[0] - image.shape[0], padded[1] - image.shape[1]
    return np.pad(image.astype(np.float64), ((0, rows), (0, columns)), constant_values=value)


def _flatten(image: np.ndarray, padded: tuple[int, int], where: np.ndarray | None = None) -> np.ndarray:
    rows, columns = padded[0] - image.shape[0], padded[1] - image.shape[1]
    grown = np.pad(image.astype(np.float64), ((0, rows), (0, columns)), mode="edge")
    flat = np.pad(grown, BORDER).ravel()
    return flat if where is None else np.where(where, flat, 0.0)


@njit(cache=True)
def _direct(planes, active, offsets, diagonal, smoothness, gradient, factor, direction, product, height, width):
    """Turn the direction to gradient + factor * direction; fill its product with the matrix, and return both's."""
    stride = width + 2 * BORDER
    total = 0.0
    for v in range(height + 2):
        if v < height:
            first = (v + BORDER) * stride + BORDER
            turned, given = direction[first : first + width], gradient[first : first + width]
            for u in range(width):
                turned[u] = factor * turned[u] + given[u]
        if v >= 2:  # the rows that this one is coupled with are turned
            first = (v - 2 + BORDER) * stride + BORDER
            last = first + width
            row, here = product[first:last], direction[first:last]
            _multiply_row(planes, active, offsets, direction, first, width, row)
            plain = diagonal[first:last]
            for u in range(width):
                row[u] = smoothness * row[u] + plain[u] * here[u]
            for u in range(width):
                total += row[u] * here[u]
    return total


@njit(cache=True)
def _multiply_row(planes, active, offsets, x, first, width, out):
    last = first + width
    centre, here = planes[0, first:last], x[first:last]
    for u in range(width):
        out[u] = centre[u] * here[u]
    for n in range(len(active)):
        k, o = active[n], offsets[n]
        ahead, behind = planes[k, first:last], planes[k, first - o : last - o]
        x_ahead, x_behind = x[first + o : last + o], x[first - o : last - o]
        for u in range(width):
            out[u] += ahead[u] * x_ahead[u] + behind[u] * x_behind[u]


@njit(cache=True)
def _two_products(first, second, common):
    one, other = 0.0, 0.0
    for i in range(len(common)):
        one += first[i] * common[i]
        other += second[i] * common[i]
    return one, other


@njit(cache=True)
def _advance(length, direction, product, solution, residual):
    for i in range(len(solution)):
        solution[i] += length * direction[i]
        residual[i] -= length * product[i]
