"""Standing an object upright."""

from __future__ import annotations

import numpy as np
import trimesh

from threedfs.object.stand import place_upright, stand_up, turn_y_up
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


def test_without_a_height_the_size_stays():
    mesh = trimesh.creation.box((2.0, 3.0, 4.0))
    mesh.apply_translation([5.0, -3.0, 1.0])
    stood = stand_up(Mesh(mesh.vertices, mesh.faces), Plane(np.array([0.0, 1.0, 0.0]), 4.5))
    assert np.allclose(np.sort(np.ptp(stood.vertices, axis=0)), [2, 3, 4])
    assert np.isclose(np.ptp(stood.vertices[:, 2]), 3) and np.isclose(stood.vertices[:, 2].min(), 0)


def test_up_is_y_where_it_was_z():
    """Exact: x stays, z becomes y, and nothing is mirrored."""
    box = trimesh.creation.box((1.0, 2.0, 3.0))
    turned = turn_y_up(Mesh(np.array([[0.0, 0, 1], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]])))
    assert turned.vertices.tolist() == [[0, 1, 0], [1, 0, 0], [0, 0, -1]]
    made = turn_y_up(Mesh(box.vertices, box.faces))
    assert np.isclose(trimesh.Trimesh(made.vertices, made.faces).volume, 6)


def test_an_upright_mesh_is_scaled_and_not_turned():
    """Exact: a box beside the origin, its sides as they were."""
    box = trimesh.creation.box((1.0, 2.0, 4.0)).apply_translation([3.0, 5.0, 7.0])
    placed = place_upright(Mesh(box.vertices, box.faces), 8.0)
    assert placed.vertices.min(axis=0).tolist() == [-1, -2, 0] and placed.vertices.max(axis=0).tolist() == [1, 2, 8]
    kept = place_upright(placed)
    assert np.array_equal(kept.vertices, placed.vertices)
