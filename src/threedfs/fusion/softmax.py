"""The soft maximum of the views' signed distances, accumulated view by view."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numba import njit, prange

from threedfs.blur import blur
from threedfs.checks import check_shape
from threedfs.fusion.view_fusion import ViewFusion
from threedfs.fusion.view_sdf import invert_depth, measure_voxel, relate
from threedfs.geometry.projection import normals_from_depth, pixel_grid
from threedfs.types import Camera, View, VoxelGrid

UNSEEN = 1.0
"""Value of voxels that no view sees: not solid, and told from empty ones by `seen` being 0."""

_FREE_RAMP = 3.0
"""Clip distances, from the first in front of a view's surface, over which its vote for free space grows to full
weight: near the surface, where the view may be wrong, it counts as much as the surface is trusted."""

_LAYERS = 8
"""Layers of the grid that `result_with` works on at one time."""

_NORMAL_SMOOTHING = 2.0
"""Standard deviation, in pixels, of the smoothing of depth before normals are taken."""


class SoftMaximum(ViewFusion):
    """Fuses the signed distances of views into one field on a grid, holding one view at a time.

    Differs from the paper, where confidence is given: a vote of trust c enters Eq. 15 as
    exp(h S - distrust (1 - c)), so that a view that others contradict loses against them instead of carving; and a
    vote on a voxel that lies behind the view's surface, which the view does not see, enters as
    exp(h S - distrust (1 - c) - hidden), with a handicap that grows from 0 at `hidden_distance` to all of it at the
    clip distance: near the surface the vote tells where it lies, deeper only that something lies before it, which is
    no evidence against a view that sees the voxel, as behind a thin part. Then no high h is needed for views that
    see a voxel to prevail, and with a low one it is their mean: a maximum takes the one that errs most. Trust
    is the confidence times how squarely the view faces the surface (`facing`), 1 at most, smoothed (`trust_blur`);
    votes for space that other views leave free are trusted fully from 1 + `_FREE_RAMP` clip distances on, and all votes
    for space before the surface by another confidence, where one is given. Without confidence every vote counts the
    same, as in the paper.

    Differs from the paper always: the sums of Eq. 15 run over the views that see a voxel, not over all, since the
    others have no S_i; and depth is not interpolated across its discontinuities (`sample_inverse_depth`).

    Parameters
    ----------
    grid : VoxelGrid
    clip_distance : float
        Distance from the surface at which votes are clipped, scene units (mu).
    hardness : float
        h of Eq. 15: 0 gives the mean, infinity the maximum.
    distrust : float
        Handicap of a vote without any confidence: what is taken off its exponent. Acts on views with confidence.
    hidden : float
        Handicap of a vote on a voxel at the clip distance behind the view's surface or farther, taken off its exponent.
        Acts on views with confidence.
    hidden_distance : float
        Distance behind the view's surface, scene units, from which that handicap grows, in proportion; it comes all at
        once at the clip distance if this is not below it. Acts on views with confidence.
    discontinuity : float
        Relative step of inverse depth between neighbouring pixels above which they lie on different surfaces.
    facing : float
        Cosine between a surface's normal and the ray to it from which a vote is trusted fully; below it the trust
        falls in proportion. Depth is worst where a surface turns away: the contour of a curved surface is another
        curve in each view. 0 for always. Acts on views with confidence.
    trust_blur : float
        Standard deviation in pixels by which trust is smoothed: votes that change from pixel to pixel roughen
        the surface. 0 for none. Acts on views with confidence.
    threads : int
        Cores used; the result does not depend on it.
    """

    def __init__(
        self,
        grid: VoxelGrid,
        clip_distance: float,
        hardness: float,
        *,
        distrust: float,
        discontinuity: float,
        hidden: float = 0.0,
        hidden_distance: float = math.inf,
        facing: float = 0.0,
        trust_blur: float = 0.0,
        threads: int = 1,
    ) -> None:
        super().__init__(grid, threads)
        self._weighted = np.zeros(grid.shape)
        self._weight = np.zeros(grid.shape)
        self._seen = np.zeros(grid.shape, np.uint8)
        self._settings = (float(clip_distance), float(hardness), float(discontinuity))
        self._distrust = distrust
        self._hidden = float(hidden)
        self._hidden_from = min(1.0, hidden_distance / clip_distance)
        self._facing = facing
        self._trust_blur = trust_blur

    def weigh(
        self,
        view: View,
        depth: np.ndarray,
        confidence: np.ndarray | None = None,
        free_depth: np.ndarray | None = None,
        front_confidence: np.ndarray | None = None,
    ) -> tuple:
        """Return what a view has to say on every voxel it sees; changes nothing.

        Voxels behind the camera, outside the image or at a pixel without depth get no vote from it.

        Parameters
        ----------
        view : View
        depth : (H, W) float, NaN where missing
        confidence : (H, W) float, 0 or more, optional
            Trust in each pixel, full from 1 on; more makes up for a surface that turns away. Without it every vote
            counts the same.
        free_depth : (H, W) float, optional
            Depth up to which no other view contradicts that the ray is free: votes for empty space well in
            front of the surface and of this depth count fully, whatever the confidence in the surface.
        front_confidence : (H, W) float, 0 or more, optional
            Trust that the space before each pixel's surface is free, where it is not that in the surface: depth that
            is wrong by being too near is right about that.

        Raises
        ------
        UserError
            If a map has not the shape of the view's images.
        """
        shape = view.camera.shape
        maps = {
            "depth": depth,
            "confidence": confidence,
            "free depth": free_depth,
            "front confidence": front_confidence,
        }
        for name, values in maps.items():
            if values is not None:
                check_shape(values, shape, f"{name} of view {view.name}")
        facing = 1.0 if confidence is None and front_confidence is None else self._face(view.camera, depth)
        handicap = np.zeros(shape) if confidence is None else self._handicap(confidence, facing)
        front = handicap if front_confidence is None else self._handicap(front_confidence, facing)
        hidden = 0.0 if confidence is None else self._hidden
        free = np.zeros(shape, np.float32) if free_depth is None else free_depth.astype(np.float32)
        return relate(self.grid, view), invert_depth(depth), handicap, front, free, hidden

    def count(self, *ballot: Any) -> None:
        """Add the votes of one view to the sums of Eq. 15."""
        _add_view(self._weighted, self._weight, self._seen, *ballot, self._hidden_from, *self._settings)

    def _face(self, camera: Camera, depth: np.ndarray) -> np.ndarray | float:
        """Return the share of its confidence that a pixel keeps for how squarely it is seen, (H, W) float64."""
        return np.clip(facing_cosine(camera, depth) / self._facing, 0.0, 1.0) if self._facing > 0 else 1.0

    def _handicap(self, confidence: np.ndarray, facing: np.ndarray | float) -> np.ndarray:
        """Return what is taken off the exponent of each pixel's vote, (H, W) float64."""
        trust = np.minimum(confidence.astype(np.float64) * facing, 1.0)
        if self._trust_blur > 0:
            trust = blur(trust, self._trust_blur)
        return self._distrust * (1.0 - trust)

    def result(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the fused field and what is known of each voxel.

        Returns
        -------
        sdf : (nx, ny, nz) float32
            In [-1, 1], positive in empty space, `UNSEEN` where no view votes (3.3.1, Eq. 15).
        seen : (nx, ny, nz) uint8
            Number of views that vote, at most 255.
        """
        sdf = np.full(self.grid.shape, UNSEEN, np.float32)
        np.divide(self._weighted, self._weight, out=sdf, where=self._seen > 0, casting="same_kind")
        return sdf, self._seen

    def result_with(self, votes: Sequence[tuple[np.ndarray, float | np.ndarray]]) -> np.ndarray:
        """Return the field, (nx, ny, nz) float32, as if fields had voted everywhere, as a view's surface does.

        Changes nothing, and holds a few layers of the grid at a time.

        Parameters
        ----------
        votes : sequence of tuple
            At least one pair: a field (nx, ny, nz) in [-1, 1], and its trust in [0, 1], a scalar or one per voxel.

        Raises
        ------
        UserError
            If a field, or its trust, does not have the shape of the grid.
        """
        for field, trust in votes:
            check_shape(field, self.grid.shape, "field")
            if isinstance(trust, np.ndarray):
                check_shape(trust, self.grid.shape, "trust in a field")
        sdf = np.empty(self.grid.shape, np.float32)
        for start in range(0, self.grid.shape[0], _LAYERS):
            part = slice(start, start + _LAYERS)
            weighted, weight = self._weighted[part].copy(), self._weight[part].copy()
            for field, trust in votes:
                own = trust[part] if isinstance(trust, np.ndarray) else trust
                vote = np.exp(self._settings[1] * (field[part].astype(np.float64) - 1) - self._distrust * (1 - own))
                weighted += vote * field[part]
                weight += vote
            np.divide(weighted, weight, out=sdf[part], casting="same_kind")
        return sdf


def facing_cosine(camera: Camera, depth: np.ndarray) -> np.ndarray:
    """Return the cosine between the surface's normal and the viewing ray, (H, W) float64, 0 where undefined.

    Normals are those of the depth smoothed over a few pixels: the turn of the surface counts, not its noise.
    """
    known = np.isfinite(depth)
    smooth = blur(np.where(known, depth, 0.0).astype(np.float64), _NORMAL_SMOOTHING)
    share = blur(known.astype(np.float64), _NORMAL_SMOOTHING)
    smooth = np.divide(smooth, share, out=np.full(depth.shape, np.nan), where=share > 0.5)
    u, v = pixel_grid(camera)
    x, y = (u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy
    length = np.sqrt(x * x + y * y + 1.0)
    normals = normals_from_depth(camera, smooth)
    along = normals[..., 0] * (x / length) + normals[..., 1] * (y / length) + normals[..., 2] * (1.0 / length)
    return np.nan_to_num(-along)


@njit(nogil=True, cache=True, parallel=True)
def _add_view(
    weighted,
    weight,
    seen,
    rays,
    inverse_depth,
    handicap,
    front,
    free_depth,
    hidden,
    hidden_from,
    clip_distance,
    hardness,
    discontinuity,
):
    nx, ny, nz = seen.shape
    for ix in prange(nx):
        for iy in range(ny):
            for iz in range(nz):
                distance, voxel_depth, row, column = measure_voxel(
                    rays, ix, iy, iz, inverse_depth, clip_distance, discontinuity
                )
                if math.isnan(distance):
                    continue
                penalty = front[row, column] if distance > 0 else handicap[row, column]
                if distance > 1.0 and voxel_depth <= free_depth[row, column]:
                    penalty *= max(0.0, 1.0 - (distance - 1.0) / _FREE_RAMP)
                elif distance < -1.0:
                    penalty += hidden
                elif distance < -hidden_from:
                    penalty += hidden * (-distance - hidden_from) / (1.0 - hidden_from)
                distance = min(1.0, max(-1.0, distance))
                # The exponent is shifted by h so that it never grows above 0; the ratio stays the same.
                vote = math.exp(hardness * (distance - 1.0) - penalty)
                weighted[ix, iy, iz] += vote * distance
                weight[ix, iy, iz] += vote
                if seen[ix, iy, iz] < 255:
                    seen[ix, iy, iz] += 1
