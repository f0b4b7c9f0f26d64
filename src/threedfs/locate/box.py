"""The box of the object, from its component on the scene grid."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy import ndimage
from scipy.spatial import ConvexHull

from threedfs.geometry.grid import world_from_index
from threedfs.geometry.plane import axes_on
from threedfs.types import Box, Plane, Support, VoxelGrid

_CORNERS = np.array(list(np.ndindex(2, 2, 2))) - 0.5
_INSIDE = 0.6
"""Share of its margin that the object may take up before the box is enlarged."""
_TIE = 1e-9
"""Relative difference of areas below which rectangles count as equal."""


def enclose_object(voxels: np.ndarray, grid: VoxelGrid, plane: Plane, margin: float) -> Box:
    """Return a box around the object and its foot, that stands on the support plane.

    Its third axis is the plane's normal; the others are those of the rectangle of least area around the object's
    footprint, the longer side first.

    Parameters
    ----------
    voxels : (nx, ny, nz) bool
        The object above the plane.
    grid : VoxelGrid
    plane : Plane
    margin : float
        What the box exceeds the object by, both sides together, as a share of the object's longest side.
    """
    shell = voxels & ~ndimage.binary_erosion(voxels)
    corners = world_from_index(grid, (np.argwhere(shell)[:, None] + _CORNERS).reshape(-1, 3))
    flat = axes_on(plane.normal)
    turn = _least_rectangle(corners @ flat[:2].T)
    axes = np.vstack([turn @ flat[:2], plane.normal])
    along = corners @ axes.T
    low, high = along.min(axis=0), along.max(axis=0)
    low[2] = min(low[2], -plane.offset - grid.spacing / 2)
    return Box(axes, low, high).grow(margin / 2 * (high - low).max())


def widen_support(support: Support, known: np.ndarray, shown: np.ndarray, grid: VoxelGrid, margin: float) -> Support:
    """Enlarge the object's box once, where what images show of the object comes near its sides.

    Parameters
    ----------
    support : Support
        With the box around the known voxels.
    known, shown : (nx, ny, nz) bool
        The object in the fused scene, and by what images show.
    grid : VoxelGrid
    margin : float
        As `enclose_object` takes it.

    Returns
    -------
    Support
        With the same box, where `shown` keeps to `_INSIDE` of its margin. Its figures tell how much of the margin
        `shown` takes up, more than 1 beyond the box, and how many times its volume the box has become.
    """
    box = support.box
    own = margin / (2 * (1 + margin)) * box.longest
    used, wide = 0.0, box
    if shown.any() and own > 0:
        along = world_from_index(grid, np.argwhere(shown)) @ box.axes.T
        beyond = np.concatenate([box.low[:2] + own - along.min(axis=0)[:2], along.max(axis=0) - (box.high - own)])
        used = float(beyond.max() / own)  # below, the support ends the object
        if used > _INSIDE:
            wide = enclose_object(known | shown, grid, support.plane, margin)
    enlarged = float(np.prod(wide.high - wide.low) / np.prod(box.high - box.low))
    return replace(support, box=wide, figures={**support.figures, "margin_used": used, "box_enlarged": enlarged})


def _least_rectangle(points: np.ndarray) -> np.ndarray:
    """Return the directions (2, 2), as rows, of the sides of the rectangle of least area around points (N, 2).

    A side of it lies along a side of the points' convex hull. Of rectangles as small as each other, as around a circle,
    it is the one turned least. The longer side is first, the second is a quarter turn to the left of it.
    """
    hull = points[ConvexHull(points).vertices]
    edges = np.diff(hull, axis=0, append=hull[:1])
    angles = np.sort(np.arctan2(edges[:, 1], edges[:, 0]) % (np.pi / 2))
    first = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    second = np.stack([-first[:, 1], first[:, 0]], axis=1)
    lengths, widths = np.ptp(hull @ first.T, axis=0), np.ptp(hull @ second.T, axis=0)
    areas = lengths * widths
    best = int(np.argmax(areas <= areas.min() * (1 + _TIE)))
    if widths[best] > lengths[best] * (1 + _TIE):
        return np.stack([second[best], -first[best]])
    return np.stack([first[best], second[best]])


def measure_thickness(voxels: np.ndarray, spacing: float) -> float:
    """Return the diameter of the largest ball that fits into the voxels (nx, ny, nz) bool, scene units."""
    (box,) = ndimage.find_objects(voxels.astype(np.uint8))
    inside = np.pad(voxels[box], 1)
    return float(spacing * (2 * ndimage.distance_transform_edt(inside).max() - 1))
