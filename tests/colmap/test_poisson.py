"""Convergence of Poisson's surface against a sphere, and what is refused."""

import numpy as np
import pytest
import trimesh

from threedfs.colmap.poisson import mesh_points
from threedfs.errors import UserError
from threedfs.types import OrientedPoints


def sphere_points(count, radius=0.5):
    normal = np.random.default_rng(0).normal(size=(count, 3))
    normal = (normal / np.linalg.norm(normal, axis=1, keepdims=True)).astype(np.float32)
    numbers = np.arange(count)
    return OrientedPoints(radius * normal, normal, np.zeros((count, 3), np.uint8), numbers, 0 * numbers)


def test_points_of_a_sphere_give_the_closed_sphere():
    mesh = mesh_points(sphere_points(5000), 6)
    distance = np.linalg.norm(mesh.vertices, axis=1) - 0.5
    assert np.abs(distance).max() < 0.02  # a cell is 0.02
    solid = trimesh.Trimesh(mesh.vertices, mesh.faces)
    assert solid.is_watertight
    assert solid.volume == pytest.approx(np.pi / 6, rel=0.01)


def test_too_few_points_are_refused():
    with pytest.raises(UserError, match="at least 100 surface points above the support plane, got 7"):
        mesh_points(sphere_points(7), 6)
