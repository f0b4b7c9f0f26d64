"""Standing an object upright on a plane at its true height."""

from __future__ import annotations

import numpy as np

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
    across = np.cross(plane.normal, np.eye(3)[np.argmin(np.abs(plane.normal))])
    across /= np.linalg.norm(across)
    axes = np.stack([across, np.cross(plane.normal, across), plane.normal])
    vertices = mesh.vertices @ axes.T
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    middle = (low + high) / 2
    vertices = (vertices - [middle[0], middle[1], low[2]]) * (height / (high[2] - low[2]))
    return Mesh(vertices, mesh.faces)
