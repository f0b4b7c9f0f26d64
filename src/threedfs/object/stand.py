"""Standing an object upright on a plane at its true height."""

from __future__ import annotations

from threedfs.geometry.plane import axes_on
from threedfs.types import Mesh, Plane


def stand_up(mesh: Mesh, plane: Plane, height: float) -> Mesh:
    """Turn a mesh so that its support plane is level, scale it to a height and put it over the origin.

    Parameters
    ----------
    mesh : Mesh
        Scene units.
    plane : Plane
        What it stands on, scene units; its normal will point along z.
    height : float
        From the lowest to the highest point, in the unit that is wanted.

    Returns
    -------
    Mesh
        Its lowest point at z = 0, the middle of its box at x = y = 0; not mirrored.
    """
    vertices = mesh.vertices @ axes_on(plane.normal).T
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    middle = (low + high) / 2
    vertices = (vertices - [middle[0], middle[1], low[2]]) * (height / (high[2] - low[2]))
    return Mesh(vertices, mesh.faces)
