"""The points of the object alone."""

from __future__ import annotations

import numpy as np

from threedfs.types import Box, OrientedPoints, Plane


def crop_points(points: OrientedPoints, box: Box, plane: Plane, clearance: float, min_sightings: int) -> OrientedPoints:
    """Keep the points in a box that lie over a plane and that enough keyframes see.

    Parameters
    ----------
    points : OrientedPoints
    box : Box
    plane : Plane
    clearance : float
        Scene units; points no farther over the plane are left out.
    min_sightings : int
        Least number of keyframes that see a point.
    """
    xyz = points.xyz.astype(np.float64)
    kept = box.contains(xyz) & (plane.distance(xyz) > clearance)
    kept &= points.sightings >= min_sightings
    return points.take(kept)
