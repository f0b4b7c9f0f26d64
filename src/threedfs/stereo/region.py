"""Where in an image a box lies."""

from __future__ import annotations

import numpy as np
from scipy.spatial import ConvexHull

from threedfs.geometry.projection import pixel_grid, project
from threedfs.types import Box, View


def mask_box(view: View, box: Box) -> np.ndarray:
    """Mark the pixels of a view whose line of sight meets a box: (H, W) bool; all, where it reaches behind the camera.

    Parameters
    ----------
    view : View
    box : Box
    """
    places, depth = project(view, box.corners())
    if depth.min() <= 0:
        return np.ones(view.camera.shape, bool)
    u, v = pixel_grid(view.camera)
    edges = ConvexHull(places).equations
    return np.all([across * u + down * v + offset <= 0 for across, down, offset in edges], axis=0)
