"""Coarse grids of a symmetric 5x5 stencil: Galerkin products with bilinear interpolation.

Coarse matrices made so keep the edges and the confident pixels of the fine one, and have a 5x5 stencil again. A
level stores 13 planes, the half stencil of `bending.HALF_OFFSETS`, flat with a border of two zeros.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from functools import cache

import numpy as np
from numba import njit

from threedfs.depth.bending import HALF_OFFSETS, STENCILS, assemble_prior

BORDER = 2
_COARSEST = 24
_PLANE_OF = {offset: k for k, offset in enumerate(HALF_OFFSETS)}


@dataclass(frozen=True)
class Level:
    """One grid of a hierarchy.

    Attributes
    ----------
    planes : (13, (H + 4) (W + 4)) float64
    shape : (H, W)
    used : indices of the planes that may hold other values than zero, ascending
    """

    planes: np.ndarray
    shape: tuple[int, int]
    used: tuple[int, ...]


def padded_shape(shape: tuple[int, int]) -> tuple[int, int]:
    """Return the least shape not under `shape` of m 2^k + 1 on each axis: every coarse border is a fine one."""
    halvings = 0
    while min(shape) > _COARSEST << halvings:
        halvings += 1
    step = 1 << halvings
    return tuple(int(-(-(n - 1) // step) * step + 1) for n in shape)


def coarsen_prior(weight: np.ndarray, prior: str) -> list[Level]:
    """Assemble a smoothness prior (see `assemble_prior`) on a padded shape and coarsen it, fine first."""
    planes = assemble_prior(weight, prior, BORDER).reshape(len(HALF_OFFSETS), -1)
    return _coarsen(Level(planes, weight.shape, STENCILS[prior]))


def coarsen_diagonal(diagonal: np.ndarray) -> list[Level]:
    """Coarsen a diagonal matrix (H, W) of a padded shape by Galerkin products, fine first."""
    planes = np.zeros((len(HALF_OFFSETS), (diagonal.shape[0] + 2 * BORDER) * (diagonal.shape[1] + 2 * BORDER)))
    planes[0] = np.pad(diagonal, BORDER).ravel()
    return _coarsen(Level(planes, diagonal.shape, (0,)))


def flat_offsets(chosen: np.ndarray, stride: int) -> np.ndarray:
    """Return the steps of the given planes in a flat bordered array with rows of `stride`."""
    offsets = np.array(HALF_OFFSETS, np.int64)[chosen]
    return offsets[:, 0] * stride + offsets[:, 1]


def _coarsen(level: Level) -> list[Level]:
    levels = [level]
    while min(levels[-1].shape) > _COARSEST + 1:
        fine = levels[-1]
        shape = ((fine.shape[0] + 1) // 2, (fine.shape[1] + 1) // 2)
        terms, shares = _galerkin_terms(fine.used)
        planes = _add_terms(fine.planes, *fine.shape, *shape, terms, shares)
        levels.append(Level(planes, shape, tuple(np.unique(terms[:, 3]).tolist())))
    return levels


@cache
def _galerkin_terms(used: tuple[int, ...]) -> tuple[np.ndarray, np.ndarray]:
    """List what a coarse stencil is the sum of, the same at every coarse node.

    Returns
    -------
    terms : (N, 4) int64
        Plane of the fine stencil; the row and column, counted from the fine node at the coarse one, at which it is
        read; plane of the coarse stencil that it adds to.
    shares : (N,) float64
        Product of the two bilinear weights.
    """
    shares = defaultdict(float)
    for here in np.ndindex(3, 3):
        v, u = here[0] - 1, here[1] - 1
        for k in used:
            for sign in (1,) if k == 0 else (1, -1):
                there = v + sign * HALF_OFFSETS[k][0], u + sign * HALF_OFFSETS[k][1]
                row, column = (v, u) if sign > 0 else there
                for parent in _parents(*there):
                    if parent in _PLANE_OF:
                        place = k, row, column, _PLANE_OF[parent]
                        shares[place] += _bilinear(v, u, (0, 0)) * _bilinear(*there, parent)
    terms = sorted(shares)
    return np.array(terms, np.int64), np.array([shares[term] for term in terms])


def _parents(v: int, u: int) -> list[tuple[int, int]]:
    """Coarse nodes that a fine node is interpolated from."""
    rows, columns = (range(n // 2, (n + 1) // 2 + 1) for n in (v, u))
    return [(row, column) for row in rows for column in columns]


def _bilinear(v: int, u: int, parent: tuple[int, int]) -> float:
    return (1 - abs(v / 2 - parent[0])) * (1 - abs(u / 2 - parent[1]))


@njit(cache=True)
def _add_terms(fine, height, width, coarse_height, coarse_width, terms, shares):
    """Sum the terms at every coarse node; beside the grid the border of zeros is read."""
    stride = width + 2 * BORDER
    coarse_stride = coarse_width + 2 * BORDER
    coarse = np.zeros((len(fine), (coarse_height + 2 * BORDER) * coarse_stride))
    for v in range(coarse_height):
        first = (v + BORDER) * coarse_stride + BORDER
        for n in range(len(terms)):
            row = 2 * v + terms[n, 1]
            if row < 0 or row >= height:
                continue
            start = (row + BORDER) * stride + BORDER + terms[n, 2]
            source = fine[terms[n, 0], start : start + 2 * coarse_width]
            out = coarse[terms[n, 3], first : first + coarse_width]
            share = shares[n]
            for u in range(coarse_width):
                out[u] += share * source[2 * u]
    return coarse
