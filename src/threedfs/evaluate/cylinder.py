"""How far the side of a can is from a cylinder."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from threedfs.errors import UserError
from threedfs.evaluate.surface import face_vectors, sample_surface
from threedfs.types import Mesh

_ROUNDS = 6
_FEW = 10
"""One point in so many takes part in all rounds but the last."""


@dataclass(frozen=True)
class Cylinder:
    """An infinite cylinder: a point on its axis, the axis (unit), the radius."""

    point: np.ndarray
    axis: np.ndarray
    radius: float

    def distance(self, points: np.ndarray) -> np.ndarray:
        """Signed distance of points (N, 3), positive outside."""
        offset = points - self.point
        return np.linalg.norm(offset - np.outer(offset @ self.axis, self.axis), axis=1) - self.radius


@dataclass(frozen=True)
class CylinderResidual:
    """Distance of the side from its own best-fit cylinder, as a share of the radius.

    Attributes
    ----------
    cylinder : Cylinder
    median, percentile_90 : float
    """

    cylinder: Cylinder
    median: float
    percentile_90: float


def measure_cylinder(
    mesh: Mesh,
    count: int,
    generator: np.random.Generator,
    normal_tolerance: float = np.deg2rad(30),
    end_trim: float = 0.1,
) -> CylinderResidual:
    """Fit a cylinder to the side of a mesh and measure what is left.

    The side is what lies more than `end_trim` of the height from either end and has a normal within
    `normal_tolerance` of perpendicular to the axis; side and fit are found in turns, from each principal direction of
    the normals, and the fit with the least median is kept.

    Parameters
    ----------
    mesh : Mesh
    count : int
        Points drawn on the surface.
    generator : numpy.random.Generator
    normal_tolerance : float
        Radians.
    end_trim : float
        Share of the height.

    Raises
    ------
    UserError
        If there is no such side that goes round the axis.
    """
    points, face = sample_surface(mesh, count, generator)
    vectors = face_vectors(mesh)[face]
    normals = vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
    fits = [
        fit
        for axis in np.linalg.eigh(normals.T @ normals)[1].T
        if (fit := _fit_from(points, normals, axis, normal_tolerance, end_trim)) is not None
    ]
    if not fits:
        raise UserError(
            "mesh: expected the side of a can to fit a cylinder to, found none; take the sequence off "
            "evaluate.cylinder_sequences if its object is no can."
        )
    return min(fits, key=lambda fit: fit.median)


def fit_cylinder(points: np.ndarray, axis: np.ndarray) -> Cylinder:
    """Fit a cylinder to points (N, 3) on its side by robust least squares, from a rough axis (3,)."""
    centroid = points.mean(0)
    spread = float(np.linalg.norm(points - centroid, axis=1).mean())
    across = np.linalg.svd(axis[None])[2][1:]

    def cylinder(unknowns: np.ndarray) -> Cylinder:
        direction = axis + unknowns[:2] @ across
        return Cylinder(
            centroid + spread * unknowns[2:4] @ across,
            direction / np.linalg.norm(direction),
            spread * unknowns[4],
        )

    def residual(unknowns: np.ndarray) -> np.ndarray:
        return cylinder(unknowns).distance(points) / spread

    # residuals beyond 1 % of the size count linearly: dents must not pull the fit
    return cylinder(least_squares(residual, [0, 0, 0, 0, 1.0], loss="soft_l1", f_scale=0.01, x_scale=0.1).x)


def _fit_from(points, normals, axis, normal_tolerance, end_trim) -> CylinderResidual | None:
    cylinder = None
    for rank in range(_ROUNDS):
        some = slice(None, None, 1 if rank == _ROUNDS - 1 else _FEW)
        height = points[some] @ axis
        low, high = height.min(), height.max()
        side = (height > low + end_trim * (high - low)) & (height < high - end_trim * (high - low))
        side &= np.abs(normals[some] @ axis) < np.sin(normal_tolerance)
        # normals that go round the axis cancel
        if side.sum() < 100 or np.linalg.norm(normals[some][side].mean(0)) > 0.5:
            return None
        cylinder = fit_cylinder(points[some][side], axis)
        axis = cylinder.axis
    share = np.abs(cylinder.distance(points[side])) / cylinder.radius
    return CylinderResidual(cylinder, float(np.median(share)), float(np.percentile(share, 90)))
