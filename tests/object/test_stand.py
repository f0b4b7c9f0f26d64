"""Standing an object upright."""

from __future__ import annotations

import numpy as np
import trimesh

from threedfs.object.stand import stand_up
from threedfs.types import Mesh, Plane


def test_tilted_box_stands_on_the_plane_with_its_own_proportions():
    box = trimesh.creation.box((2.0, 3.0, 4.0))
    rotation = trimesh.transformations.random_rotation_matrix(np.random.default_rng(3).random(3))[:3, :3]
    vertices = box.vertices @ rotation.T * 0.1 + [5.0, -3.0, 1.0]
    normal = rotation[:, 2]
    plane = Plane(normal, float(-(vertices @ normal).min()))
    stood = stand_up(Mesh(vertices, box.faces), plane, 80.0)
    assert np.allclose([stood.vertices[:, 2].min(), stood.vertices[:, 2].max()], [0.0, 80.0])
    assert np.allclose(stood.vertices[:, :2].min(axis=0), -stood.vertices[:, :2].max(axis=0))
    assert np.isclose(trimesh.Trimesh(stood.vertices, stood.faces).volume, 2 * 3 * 4 * 20**3)  # not mirrored either
