"""Where a camera sees a mesh, told by its vertices alone."""

from __future__ import annotations

import cv2
import numpy as np

from threedfs.evaluate.masks import intersection_over_union
from threedfs.poses.given import GivenCamera, state_size

_FAR_OUT = 1e5  # pixels; what is farther from the image is drawn there


def see_points(points: np.ndarray, given: GivenCamera) -> bool:
    """Say whether a camera sees any of the points (N, 3) of its world, as if nothing were before them.

    A camera that does not state the size of its images is taken to have its centre in their middle.
    """
    camera = given.lens.camera
    height, width = (camera.height, camera.width) if camera.width else (2 * camera.cy + 1, 2 * camera.cx + 1)
    pixels = _project(points, given)
    return bool(np.any(np.all((pixels > -0.5) & (pixels < (width - 0.5, height - 0.5)), axis=1)))


def compare_outlines(vertices: np.ndarray, given: GivenCamera, mask: np.ndarray) -> float | None:
    """Return the intersection over union of the convex hulls of a mesh in an image and of a mask (H, W) bool.

    None for a mask without an object. The hull of a silhouette is that of the vertices (N, 3): no ray is cast.
    """
    if not mask.any():
        return None
    lens = state_size(given.lens, mask.shape).resize(mask.shape[1], mask.shape[0])
    pixels = _project(vertices, GivenCamera(given.name, None, lens, given.cam_from_world))
    rows, columns = np.nonzero(mask)
    return intersection_over_union(_fill(pixels, mask.shape), _fill(np.stack([columns, rows], axis=1), mask.shape))


def _project(points: np.ndarray, given: GivenCamera) -> np.ndarray:
    """Return the pixels (M, 2) at which a lens shows those of the points (N, 3) that it can show."""
    points = points @ given.cam_from_world[:3, :3].T + given.cam_from_world[:3, 3]
    points = points[points[:, 2] > 0]
    pixels = given.lens.denormalise(points[:, :2] / points[:, 2:])
    return pixels[np.isfinite(pixels).all(axis=1)]


def _fill(pixels: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """Draw the convex hull of pixels (N, 2) as a mask of a shape."""
    drawn = np.zeros(shape, np.uint8)
    if len(pixels):
        corners = cv2.convexHull(np.clip(pixels, -_FAR_OUT, _FAR_OUT).astype(np.float32))
        cv2.fillConvexPoly(drawn, np.rint(corners).astype(np.int32), 1)
    return drawn.astype(bool)
