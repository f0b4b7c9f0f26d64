"""The object on its own grid: found once in a field, for all that follows."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from threedfs.errors import UserError
from threedfs.locate.component import choose_component, mark_points
from threedfs.locate.fixation import find_fixation, viewing_distance
from threedfs.locate.height import add_foot, height_above, known_above
from threedfs.types import Plane, Support, View, VoxelGrid


@dataclass(frozen=True)
class Located:
    """Where the object is in a field.

    Attributes
    ----------
    grid : VoxelGrid
    plane : Plane
        The support surface.
    voxels : (nx, ny, nz) bool
        The object from the plane upwards.
    least_height : float
        Height over the plane from which solids were looked at, scene units; what the object has below is its foot.
    supported : int
        Number of voxels above that which hold a semi-dense point, or lie beside one that does.
    rivals : int
        Number of other components that any point supports.
    """

    grid: VoxelGrid
    plane: Plane
    voxels: np.ndarray
    least_height: float
    supported: int
    rivals: int

    @property
    def height(self) -> np.ndarray:
        """(nx, ny, nz) float32, of each voxel over the plane, scene units."""
        return height_above(self.plane, self.grid)


def stand_on(grid: VoxelGrid, plane: Plane, voxels: np.ndarray, least_height: float) -> Located:
    """Return known voxels (nx, ny, nz) bool of an object, all of them above `least_height`, with its foot."""
    height = height_above(plane, grid)
    return Located(grid, plane, add_foot(voxels, height, grid, plane, least_height) & (height > 0), least_height, 0, 0)


def find_object(
    grid: VoxelGrid,
    sdf: np.ndarray,
    seen: np.ndarray,
    support: Support,
    views: Sequence[View],
    clouds: Iterable[np.ndarray],
    *,
    least_height: float,
    reach: float,
) -> Located:
    """Find the object in a field, and its foot on the plane.

    Differs from the paper: voxels are above the support from `least_height` on, some voxels or more where the plane is
    noisy (paper: 0.05 of the spread of its points), and the foot below it is the object's too; `choose_component` says
    which one.

    Parameters
    ----------
    grid : VoxelGrid
    sdf, seen : (nx, ny, nz)
        The field, and how many views see each voxel.
    support : Support
    views : sequence of View
    clouds : iterable of (N, 3) float64
        Semi-dense points, world.
    least_height : float
        Scene units.
    reach : float
        Standard deviation of a component's worth over its distance from what the views look at, viewing distances.

    Raises
    ------
    UserError
        If the field holds no solid with semi-dense points above the support plane.
    """
    fixation = find_fixation(views, support.box.centre)
    height, holds = height_above(support.plane, grid), np.zeros(grid.shape, bool)
    for cloud in clouds:
        mark_points(grid, cloud, holds)
    above = known_above(seen, height, least_height)
    distance = reach * viewing_distance(views, fixation)
    chosen = choose_component((sdf < 0) & above, grid, holds & (height > least_height), fixation, reach=distance)
    if chosen is None:
        raise UserError(
            "Expected a solid above the support plane with semi-dense points on it, found none; the depth maps "
            "disagree on the object (shiny, transparent or without texture?), or locate_object.clearance is above it."
        )
    voxels = add_foot(chosen.voxels, height, grid, support.plane, least_height) & (height > 0)
    return Located(grid, support.plane, voxels, least_height, chosen.support, chosen.rivals)
