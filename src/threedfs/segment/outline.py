"""Silhouettes of sets of voxels."""

from __future__ import annotations

from collections.abc import Mapping

import cv2
import numpy as np
from scipy import ndimage
from skimage.measure import marching_cubes

from threedfs.geometry.grid import world_from_index
from threedfs.object.silhouettes import draw_silhouette
from threedfs.read_ahead import map_ahead
from threedfs.types import Mesh, View, VoxelGrid


def surround_voxels(voxels: np.ndarray, grid: VoxelGrid) -> Mesh:
    """Return the closed surface, of any number of shells, half way between the voxels of a set and those outside.

    Parameters
    ----------
    voxels : (nx, ny, nz) bool
        One at least.
    grid : VoxelGrid
    """
    (box,) = ndimage.find_objects(voxels.astype(np.uint8))
    padded = np.pad(voxels[box], 1).astype(np.float32)
    vertices, faces, _, _ = marching_cubes(padded, 0.5, gradient_direction="ascent", method="lorensen")
    start = np.array([part.start for part in box]) - 1
    return Mesh(world_from_index(grid, vertices.astype(np.float64) + start), faces.astype(np.int64))


def draw_voxels(
    voxels: np.ndarray, grid: VoxelGrid, views: Mapping[str, View], threads: int = 1
) -> dict[str, np.ndarray]:
    """Return the silhouette (H, W) bool of a set of voxels in each view; nothing where the set is empty."""
    if not voxels.any():
        return {name: np.zeros(view.camera.shape, bool) for name, view in views.items()}
    surface = surround_voxels(voxels, grid)
    drawn = map_ahead(lambda view: draw_silhouette(surface, view), views.values(), threads=threads)
    return dict(zip(views, drawn, strict=True))


def depth_inside(mask: np.ndarray) -> np.ndarray:
    """Return the distance (H, W) float32, pixels, of each pixel from the outline of a mask (H, W) bool.

    Negative outside. The outline runs between pixels, so that none is nearer to it than half a pixel.
    """
    own, other = (_distance_inside(part) for part in (mask, ~mask))
    return np.where(mask, own - 0.5, 0.5 - other)


def _distance_inside(mask: np.ndarray) -> np.ndarray:
    """Return the exact distance (H, W) float32, pixels, of each pixel of a mask from the nearest one outside of it.

    Where it may use one thread only, OpenCV leaves this to IPP (as of 5.0), whose last bits change with the place of
    the array in memory; its own code is exact on any number of threads.
    """
    before = cv2.ipp.useIPP()
    cv2.ipp.setUseIPP(False)
    try:
        return cv2.distanceTransform(mask.astype(np.uint8), cv2.DIST_L2, 0)
    finally:
        cv2.ipp.setUseIPP(before)


def largest_piece(voxels: np.ndarray) -> np.ndarray:
    """Return the largest 6-connected piece of a set of voxels (nx, ny, nz) bool."""
    labels, _ = ndimage.label(voxels)
    return labels == np.bincount(labels[voxels]).argmax()


def grow_voxels(voxels: np.ndarray, steps: int) -> np.ndarray:
    """Return a set of voxels (nx, ny, nz) bool with all that are no farther than `steps` voxels from it."""
    return voxels if steps == 0 else ndimage.distance_transform_edt(~voxels) <= steps
