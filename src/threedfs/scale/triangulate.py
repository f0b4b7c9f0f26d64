"""One point of the scene from all frames that see it, robustly."""

from __future__ import annotations

import numpy as np

_ROUNDS = 15
_TOLERANCE = 0.5  # pixels: errors beyond it count less and less


def triangulate(rays: np.ndarray, cam_from_world: np.ndarray, focal: float) -> np.ndarray:
    """Find the point whose projections are nearest to where it is seen, by weighted least squares of Cauchy's weights.

    Parameters
    ----------
    rays : (N, 2) float64
        Undistorted normalised coordinates (x, y) by frame; N at least 2.
    cam_from_world : (N, 4, 4) float64
    focal : float
        Focal length that makes pixels of normalised coordinates.

    Returns
    -------
    (3,) float64
        World, scene units; NaN where the rays leave it open or the point lies behind a camera.
    """
    rotation, translation = cam_from_world[:, :3, :3], cam_from_world[:, :3, 3]
    # x (r3 X + t3) = r1 X + t1 and the same for y: two rows a frame, in units of depth
    rows = rays[..., None] * rotation[:, 2:3] - rotation[:, :2]
    right = translation[:, :2] - rays * translation[:, 2:3]
    weights = np.ones(len(rays))
    point = np.full(3, np.nan)
    for _ in range(_ROUNDS):
        left = np.einsum("n,nki,nkj->ij", weights, rows, rows)
        if np.linalg.cond(left) > 1e12:
            return np.full(3, np.nan)
        point = np.linalg.solve(left, np.einsum("n,nki,nk->i", weights, rows, right))
        depth = np.einsum("ni,i->n", rotation[:, 2], point) + translation[:, 2]
        if np.median(depth) <= 0:
            return np.full(3, np.nan)
        depth = np.maximum(depth, 1e-6 * float(np.median(depth)))
        errors = focal * np.linalg.norm(np.einsum("nki,i->nk", rows, point) - right, axis=1) / depth
        weights = 1 / (depth**2 * (1 + (errors / _TOLERANCE) ** 2))
    return point
