"""Which sparse points a frame sees, and from where."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from threedfs.geometry.projection import inside, project
from threedfs.types import SparsePoints, View


@dataclass(frozen=True)
class Visibility:
    """What F posed frames see of P sparse points.

    Attributes
    ----------
    centres : (F, 3) float64
        Camera centres, world, scene units.
    xyz : (P, 3) float64
        The points, world, scene units.
    depth : (F, P) float64
        Depth of each point in each frame, scene units; NaN where it does not fall on the valid image.
    seen : (F, P) bool
        Points triangulated from the frame; for a frame without any, those that fall on its image.
    """

    centres: np.ndarray
    xyz: np.ndarray
    depth: np.ndarray
    seen: np.ndarray

    @property
    def in_view(self) -> np.ndarray:
        """(F, P) bool, points that fall on the valid image; they may be hidden there by something else."""
        return np.isfinite(self.depth)


def find_visibility(views: Sequence[View], points: SparsePoints, valid: np.ndarray) -> Visibility:
    """Project all points into all frames.

    Parameters
    ----------
    views : sequence of View
        Posed frames, in the order that the tracks of `points` count.
    points : SparsePoints
    valid : (H, W) bool
        Pixels that show the scene.
    """
    depth = np.stack([_depth_in_view(view, points.xyz, valid) for view in views])
    in_view = np.isfinite(depth)
    seen = np.zeros_like(in_view)
    seen[points.track_frame, points.track_point] = True
    seen &= in_view
    seen = np.where(seen.any(axis=1, keepdims=True), seen, in_view)
    return Visibility(np.stack([view.centre for view in views]), points.xyz, depth, seen)


def _depth_in_view(view, xyz, valid):
    pixels, depth = project(view, xyz)
    on_image = inside(view.camera, pixels)
    u, v = np.rint(np.where(on_image[:, None], pixels, 0)).astype(np.int64).T
    return np.where(on_image & valid[v, u], depth, np.nan)
