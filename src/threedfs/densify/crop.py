"""The points of the object alone."""

from __future__ import annotations

import numpy as np

from threedfs.types import OrientedPoints, Plane


def crop_points(
    points: OrientedPoints, low: np.ndarray, high: np.ndarray, plane: Plane, clearance: float, min_sightings: int
) -> OrientedPoints:
    """Keep the points in a box that lie over a plane and that enough keyframes see.

    Parameters
    ----------
    points : OrientedPoints
    low, high : (3,) float64
        Corners of the box, world.
    plane : Plane
    clearance : float
        Scene units; points no farther over the plane are left out.
    min_sightings : int
        Least number of keyframes that see a point.
    """
    xyz = points.xyz.astype(np.float64)
    kept = ((xyz >= low) & (xyz <= high)).all(axis=1) & (plane.distance(xyz) > clearance)
    kept &= points.sightings >= min_sightings
    renumbered = np.cumsum(kept) - 1
    seen = kept[points.seen_point]
    return OrientedPoints(
        points.xyz[kept],
        points.normal[kept],
        points.rgb[kept],
        renumbered[points.seen_point[seen]],
        points.seen_view[seen],
    )
