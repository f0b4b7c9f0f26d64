"""Which nodes had better agree: neighbouring superpixels, neighbouring voxels, and voxels with what shows them."""

from __future__ import annotations

import numpy as np

from threedfs.geometry.grid import voxel_index
from threedfs.segment.superpixels import Superpixels
from threedfs.types import VoxelGrid


def superpixel_weights(superpixels: Superpixels, falloff: float, pair_edge: str) -> np.ndarray:
    """Return the cost (P,) float32 of different labels across each boundary (Eq. 28).

    Differs from the paper: with `mean` the fall-off is over the mean contour strength of the boundary, times its
    length in units of a mean boundary; printed is the `sum` over its pixels, which leaves no cost on long boundaries.
    Whether these are the pixels of both superpixels or of `one_side`, about half of them, the paper does not say.

    Parameters
    ----------
    superpixels : Superpixels
    falloff : float
        Paper: 2.
    pair_edge : {"mean", "sum", "one_side"}
    """
    if pair_edge != "mean":
        return np.exp(-falloff * (superpixels.edge_sum if pair_edge == "sum" else superpixels.edge_sum / 2))
    length = superpixels.boundary / superpixels.boundary.mean()
    return (length * np.exp(-falloff * superpixels.edge_sum / superpixels.boundary)).astype(np.float32)


def voxel_pairs(is_open: np.ndarray) -> np.ndarray:
    """Return the pairs (P, 2) int32 of 6-connected voxels of which one at least is open, by flat index.

    Parameters
    ----------
    is_open : (nx, ny, nz) bool
    """
    number = np.arange(is_open.size, dtype=np.int32).reshape(is_open.shape)
    found = []
    for axis in range(3):
        first = tuple(slice(None, -1) if d == axis else slice(None) for d in range(3))
        second = tuple(slice(1, None) if d == axis else slice(None) for d in range(3))
        either = is_open[first] | is_open[second]
        found.append(np.stack([number[first][either], number[second][either]], axis=1))
    return np.concatenate(found)


def link_voxels(
    superpixels: Superpixels, points: np.ndarray, rows: np.ndarray, columns: np.ndarray, grid: VoxelGrid
) -> tuple[np.ndarray, np.ndarray]:
    """Link superpixels with the voxels that hold the points of their pixels.

    Parameters
    ----------
    superpixels : Superpixels
    points : (N, 3) float64
        World points that pixels (rows, columns) show.
    rows, columns : (N,) int64
    grid : VoxelGrid

    Returns
    -------
    pairs : (M, 2) int64
        Superpixel and flat index of the voxel, each pair once.
    share : (M,) float64
        Share of the superpixel's pixels that the pair stands for.
    """
    voxels, kept = voxel_index(grid, points)
    owner = superpixels.index[rows[kept], columns[kept]].astype(np.int64)
    flat = np.ravel_multi_index(tuple(voxels.T), grid.shape)
    size = int(np.prod(grid.shape))
    keys, count = np.unique((owner * size + flat)[owner >= 0], return_counts=True)
    pairs = np.stack([keys // size, keys % size], axis=1)
    return pairs, count / superpixels.sizes[pairs[:, 0]]
