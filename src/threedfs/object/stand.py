"""Standing an object upright on a plane, at its true height where that is known."""

from __future__ import annotations

import numpy as np

from threedfs.geometry.plane import axes_on
from threedfs.types import Mesh, Plane


def stand_up(mesh: Mesh, plane: Plane, height: float | None = None) -> Mesh:
    """Turn a mesh so that its support plane is level, scale it to a height and put it over the origin.

    Parameters
    ----------
    mesh : Mesh
        Scene units.
    plane : Plane
        What it stands on, scene units; its normal will point along z.
    height : float, optional
        From the lowest to the highest point, in the unit that is wanted; without it, the mesh keeps its size.

    Returns
    -------
    Mesh
        Its lowest point at z = 0, the middle of its box at x = y = 0; not mirrored.
    """
    return place_upright(Mesh(mesh.vertices @ axes_on(plane.normal).T, mesh.faces), height)


def place_upright(mesh: Mesh, height: float | None = None) -> Mesh:
    """Scale a mesh whose z points up to a height and put it over the origin, as `stand_up` does; not turned."""
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    middle = (low + high) / 2
    scale = 1.0 if height is None else height / (high[2] - low[2])
    return Mesh((mesh.vertices - [middle[0], middle[1], low[2]]) * scale, mesh.faces)


def height_on(mesh: Mesh, plane: Plane) -> float:
    """Return how far a mesh reaches from its lowest to its highest point over a plane, scene units."""
    return float(np.ptp((mesh.vertices @ axes_on(plane.normal).T)[:, 2]))


def turn_y_up(mesh: Mesh) -> Mesh:
    """Turn a mesh whose z points up so that y does, as GLB wants it; not mirrored."""
    x, y, z = mesh.vertices.T
    return Mesh(np.stack([x, z, -y], axis=1), mesh.faces)
