"""Motion blur: an image spread along the way that each of its pixels goes while the shutter is open."""

from __future__ import annotations

import numpy as np
from numba import njit

from threedfs.types import Camera

# A step along the way is at most this long, px; a longer way is covered by at most so many steps.
_STEP = 1.0
_MOST_STEPS = 24
# Relative difference in depth from which on a nearer pixel belongs to another surface.
_NEARER = 0.97


def image_motion(
    camera: Camera, depth: np.ndarray, start: np.ndarray, end: np.ndarray, middle: np.ndarray
) -> np.ndarray:
    """Return how far (H, W, 2) each pixel of the view at `middle` goes in the image between two poses, px.

    Parameters
    ----------
    camera : Camera
    depth : (H, W) float64
        Seen from `middle`, scene units.
    start, end, middle : (4, 4) float64
        `cam_from_world`.
    """
    # From homogeneous (u, v, 1, 1 / depth) of the middle to homogeneous pixels of the ends.
    to_rays = np.eye(4)
    to_rays[:3, :3] = np.linalg.inv(camera.px_from_cam)
    maps = [camera.px_from_cam @ (pose @ np.linalg.inv(middle))[:3] @ to_rays for pose in (start, end)]
    return _motion(depth, maps[0], maps[1])


@njit(cache=True)
def _motion(depth: np.ndarray, to_start: np.ndarray, to_end: np.ndarray) -> np.ndarray:
    height, width = depth.shape
    out, ends = np.empty((height, width, 2)), np.empty(4)
    for v in range(height):
        for u in range(width):
            near = 1 / depth[v, u]
            for k, to in enumerate((to_start, to_end)):
                forward = max(to[2, 0] * u + to[2, 1] * v + to[2, 2] + to[2, 3] * near, 1e-3)
                for d in range(2):
                    ends[2 * k + d] = (to[d, 0] * u + to[d, 1] * v + to[d, 2] + to[d, 3] * near) / forward
            out[v, u, 0], out[v, u, 1] = ends[2] - ends[0], ends[3] - ends[1]
    return out


def smear(image: np.ndarray, depth: np.ndarray, motion: np.ndarray) -> np.ndarray:
    """Average an image (H, W, 3) float64 along the motion (H, W, 2) of its pixels, px, centred on them.

    What lies nearer than a pixel (by `depth`, (H, W)) does not enter it: a sharp object stays sharp before a
    background that moves.
    """
    return _smear(np.ascontiguousarray(image), depth, motion, _STEP, _MOST_STEPS, _NEARER)


@njit(cache=True)
def _smear(
    image: np.ndarray, depth: np.ndarray, motion: np.ndarray, step: float, most: int, nearer: float
) -> np.ndarray:
    height, width = depth.shape
    out = np.empty_like(image)
    total = np.empty(3)
    for row in range(height):
        for column in range(width):
            du, dv = motion[row, column]
            count = min(int(np.sqrt(du * du + dv * dv) / step) + 1, most)
            total[:] = 0.0
            taken = 0
            for k in range(count):
                along = (k + 0.5) / count - 0.5
                u = min(max(column + along * du, 0.0), width - 1.0)
                v = min(max(row + along * dv, 0.0), height - 1.0)
                if depth[int(v + 0.5), int(u + 0.5)] < nearer * depth[row, column]:
                    continue
                i, j = min(int(v), height - 2), min(int(u), width - 2)
                a, b = v - i, u - j
                for c in range(3):
                    upper = (1 - b) * image[i, j, c] + b * image[i, j + 1, c]
                    lower = (1 - b) * image[i + 1, j, c] + b * image[i + 1, j + 1, c]
                    total[c] += (1 - a) * upper + a * lower
                taken += 1
            for c in range(3):
                out[row, column, c] = total[c] / taken if taken else image[row, column, c]
    return out
