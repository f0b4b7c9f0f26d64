"""How far surface points are to be believed against the field."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import map_coordinates

from threedfs.errors import UserError
from threedfs.geometry.grid import voxel_from_world
from threedfs.geometry.plane import widest_gap
from threedfs.types import OrientedPoints, Plane, VoxelGrid

_PLACE = 3.0
"""Side of a place of the field's surface, voxels."""

_LEAST_OVER_PLACE = 5
"""Points over a place from which they tell how far they scatter."""

_LEAST_POINTS = 50
_WIDEST_GAP = 270.0
"""Degrees around the object without any point from which its points are all on one side."""


@dataclass(frozen=True)
class SurfaceSamples:
    """Points where the field should be zero, or means of such points.

    Attributes
    ----------
    xyz : (N, 3) float64, world
    sdf : (N,) float64
        The field there, or its mean at the points.
    trust : (N,) float64, above 0
        How much each counts in the fit; at most 1 for a point.
    """

    xyz: np.ndarray
    sdf: np.ndarray
    trust: np.ndarray


def sample_field(sdf: np.ndarray, grid: VoxelGrid, points: np.ndarray) -> np.ndarray:
    """Interpolate a field at points (N, 3), world: (N,) float64, NaN outside the grid."""
    places = voxel_from_world(grid, points.astype(np.float64))
    values = map_coordinates(sdf.astype(np.float64), places.T, order=1, mode="nearest")
    inside = ((places >= 0) & (places <= np.array(grid.shape) - 1)).all(axis=1)
    return np.where(inside, values, np.nan)


def sample_gradient(sdf: np.ndarray, grid: VoxelGrid, points: np.ndarray) -> np.ndarray:
    """Return the field's direction of ascent at points: (N, 3) float64, world, of length 1, 0 where it is flat."""
    steps = grid.spacing * grid.axes
    rise = [
        np.nan_to_num(sample_field(sdf, grid, points + step) - sample_field(sdf, grid, points - step)) for step in steps
    ]
    gradient = np.stack(rise, axis=1) @ grid.axes
    return gradient / np.maximum(np.linalg.norm(gradient, axis=1, keepdims=True), 1e-12)


def take_points(
    points: OrientedPoints,
    sdf: np.ndarray,
    seen: np.ndarray,
    grid: VoxelGrid,
    *,
    reach: float,
    min_cosine: float,
    full_sightings: int,
) -> SurfaceSamples:
    """Choose the points that may correct a field, and say how far each is trusted.

    Differs from the paper, which takes every point: a point counts if the field is known and near zero there, and
    ascends along the point's normal. Its trust is the cosine between the two, times its share of
    `full_sightings`, 1 at most.

    Parameters
    ----------
    points : OrientedPoints
    sdf, seen : (nx, ny, nz)
        The field and the number of views that see each voxel.
    grid : VoxelGrid
    reach : float
        Largest |sdf| at a point.
    min_cosine : float
        Least cosine between normal and gradient; with -1 all directions pass and trust is 1, as in the paper.
    full_sightings : int
        Keyframes that see a point for it to be trusted fully.
    """
    value = sample_field(sdf, grid, points.xyz)
    known = sample_field((seen > 0).astype(np.float32), grid, points.xyz) > 0.5
    kept = known & (np.abs(np.nan_to_num(value, nan=np.inf)) <= reach)
    xyz = points.xyz[kept].astype(np.float64)
    if min_cosine <= -1:
        return SurfaceSamples(xyz, value[kept], np.ones(len(xyz)))
    cosine = (sample_gradient(sdf, grid, xyz) * points.normal[kept]).sum(axis=1)
    trust = np.clip(cosine, 0.01, 1) * np.minimum(1, points.sightings[kept] / full_sightings)
    agrees = cosine >= min_cosine
    return SurfaceSamples(xyz[agrees], value[kept][agrees], trust[agrees])


def measure_scatter(samples: SurfaceSamples, sdf: np.ndarray, grid: VoxelGrid) -> float:
    """Return how far points over one place of the field's surface scatter along its normal, voxels.

    The median over points of the distance from the mean of those over the same place: a field that is wrong in the
    same way for all of them adds nothing. 0 where no place has enough of them. Not in the paper, which believes all
    points alike.

    Parameters
    ----------
    samples : SurfaceSamples
        Points, not means.
    sdf : (nx, ny, nz) float32
    grid : VoxelGrid
    """
    ascent = sample_gradient(sdf, grid, samples.xyz)
    step = grid.spacing * ascent
    rise = sample_field(sdf, grid, samples.xyz + step) - sample_field(sdf, grid, samples.xyz - step)
    slope = max(float(np.nanmedian(rise)) / (2 * grid.spacing), 1e-9)
    foot = samples.xyz - (samples.sdf / slope)[:, None] * ascent
    place, count = _number_cells(grid, foot, _PLACE)
    mean = np.bincount(place, samples.sdf) / count
    apart = np.abs(samples.sdf - mean[place])[count[place] >= _LEAST_OVER_PLACE]
    return float(np.median(apart)) / (slope * grid.spacing) if len(apart) else 0.0


def believe_scattered(scatter: float, limit: float) -> float:
    """Return how much points count that scatter so far, in (0, 1]: beyond a limit (same unit) as the inverse variance.

    Not in the paper, which believes all points alike.

    Examples
    --------
    >>> believe_scattered(0.3, 0.6), believe_scattered(1.2, 0.6)
    (1.0, 0.25)
    """
    return (limit / max(scatter, limit)) ** 2


def average_in_cells(samples: SurfaceSamples, grid: VoxelGrid, size: float, belief: float = 1.0) -> SurfaceSamples:
    """Return one sample for every cell of space that has some: their mean by trust, with their trust together.

    Trust is scaled to a mean of `belief`, so that the fit weighs samples against its ridge the same however many points
    there are. A cell that many points lie in counts more than one that few do: surfaces are where points agree. The
    field is averaged too, not looked up at the mean place, which is off a curved surface.

    Differs from the paper, which draws points at random: there most points are left aside, and each that is drawn has
    an error of its own.

    Parameters
    ----------
    samples : SurfaceSamples
    grid : VoxelGrid
        Cells lie along its axes.
    size : float
        Side of a cell, voxels.
    belief : float
        Mean trust of the cells, in (0, 1].
    """
    cell, _ = _number_cells(grid, samples.xyz, size)
    trust = np.bincount(cell, samples.trust)
    weight = samples.trust / trust[cell]
    xyz = np.stack([np.bincount(cell, weight * places) for places in samples.xyz.T], axis=1)
    return SurfaceSamples(xyz, np.bincount(cell, weight * samples.sdf), belief * (trust / trust.mean()))


def _number_cells(grid: VoxelGrid, points: np.ndarray, size: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the number of the cell that each point (N, 3) lies in, (N,) int, and how many lie in each, (C,) int."""
    places = voxel_from_world(grid, points)
    corner = ((places - places.min(axis=0)) / size).astype(np.int64)
    _, cell, count = np.unique(corner, axis=0, return_inverse=True, return_counts=True)
    return cell.ravel(), count


def check_samples(samples: SurfaceSamples, centre: np.ndarray, plane: Plane) -> None:
    """Refuse points that cannot tell where the object's surface is.

    Parameters
    ----------
    samples : SurfaceSamples
    centre : (3,) float64
        Of the object's box, world.
    plane : Plane
        The support surface.

    Raises
    ------
    UserError
        If they are too few, or all lie within a quarter turn around the object.
    """
    advice = "raise densify.max_cost, or set densify.points to off to go on without the correction."
    if len(samples.xyz) < _LEAST_POINTS:
        raise UserError(
            f"Expected at least {_LEAST_POINTS} surface points near the fused surface of the object, found "
            f"{len(samples.xyz)}; the object has too little texture, or the keyframes are too far apart; {advice}"
        )
    gap = widest_gap(samples.xyz - centre, plane.normal)
    if gap > _WIDEST_GAP:
        raise UserError(
            f"Expected surface points around the object, found all of them within {360 - gap:.0f} degrees; "
            f"the other sides were not filmed or have no texture; {advice}"
        )
