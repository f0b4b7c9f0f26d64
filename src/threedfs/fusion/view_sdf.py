"""The signed distance of voxels from the depth surface of one view."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from threedfs.types import View, VoxelGrid

Rays = tuple[np.ndarray, np.ndarray]
"""(3, 4) projection of homogeneous voxel indices, and (fx, fy, cx, cy), of a view: what kernels work with."""


def relate(grid: VoxelGrid, view: View) -> Rays:
    """Return what `measure_voxel` needs of a grid and a view."""
    camera = view.camera
    intrinsics = np.array([camera.fx, camera.fy, camera.cx, camera.cy])
    return view.px_from_world @ grid.world_from_voxel, intrinsics


def invert_depth(depth: np.ndarray) -> np.ndarray:
    """Return the inverse depth, (H, W) float32, NaN where the depth is not a positive finite number.

    Between pixels of a plane inverse depth is linear, depth is not: interpolation is exact there.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(np.isfinite(depth) & (depth > 0), 1 / depth, np.nan).astype(np.float32)


@njit(cache=True)
def sample_inverse_depth(inverse_depth, u, v, discontinuity):
    """Return the inverse depth at a point (u, v) of the image, NaN outside it or where it is missing.

    Bilinear where the four pixels around lie on one surface, that is, where they spread over at most
    `discontinuity` times the nearest one's value; the nearest pixel's value across a depth discontinuity,
    where a mean would be a surface that does not exist.

    Differs from the paper: its depth surface is in one piece, which a large `discontinuity` gives.
    """
    rows, columns = inverse_depth.shape
    if not (u >= 0 and v >= 0 and u <= columns - 1 and v <= rows - 1):
        return np.nan
    nearest = inverse_depth[int(v + 0.5), int(u + 0.5)]
    if math.isnan(nearest):
        return np.nan
    column, row = min(int(u), columns - 2), min(int(v), rows - 2)
    right, down = u - column, v - row
    a, b = inverse_depth[row, column], inverse_depth[row, column + 1]
    c, d = inverse_depth[row + 1, column], inverse_depth[row + 1, column + 1]
    total = a + b + c + d
    if math.isnan(total) or max(a, b, c, d) - min(a, b, c, d) > discontinuity * nearest:
        return nearest
    return (1 - down) * ((1 - right) * a + right * b) + down * ((1 - right) * c + right * d)


@njit(cache=True)
def signed_distance(surface_depth, voxel_depth, ray_length, clip_distance):
    """Return the signed distance of a voxel from the depth surface along its ray, not yet clipped (3.3.1, Eq. 14).

    In units of the clip distance; clipped to [-1, 1] it is the S_i of Eq. 14.
    The voxel and the point where its ray meets the surface differ by a multiple of that ray, so the norm of
    their difference is the difference in depth times the length of the ray at depth 1. The sign of that
    difference in depth is the sign of the result: positive in front of the surface.
    """
    return (surface_depth - voxel_depth) * ray_length / clip_distance


@njit(cache=True, inline="always")
def measure_voxel(rays, ix, iy, iz, inverse_depth, clip_distance, discontinuity):
    """Return a voxel's signed distance (see `signed_distance`), its depth, and its pixel's row and column.

    The distance is NaN for a voxel behind the camera, outside the image or at a pixel without depth.
    """
    p, intrinsics = rays
    depth = p[2, 0] * ix + p[2, 1] * iy + p[2, 2] * iz + p[2, 3]
    if depth <= 0:
        return np.nan, depth, 0, 0
    u = (p[0, 0] * ix + p[0, 1] * iy + p[0, 2] * iz + p[0, 3]) / depth
    v = (p[1, 0] * ix + p[1, 1] * iy + p[1, 2] * iz + p[1, 3]) / depth
    inverse = sample_inverse_depth(inverse_depth, u, v, discontinuity)
    if math.isnan(inverse):
        return np.nan, depth, 0, 0
    fx, fy, cx, cy = intrinsics[0], intrinsics[1], intrinsics[2], intrinsics[3]
    ray_length = math.sqrt(((u - cx) / fx) ** 2 + ((v - cy) / fy) ** 2 + 1.0)
    distance = signed_distance(1.0 / inverse, depth, ray_length, clip_distance)
    return distance, depth, int(v + 0.5), int(u + 0.5)
