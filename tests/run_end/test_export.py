"""Writing an object's mesh for other programs."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from threedfs.errors import UserError
from threedfs.io.colored_meshes import read_colored_mesh, write_colored_mesh
from threedfs.io.meshes import read_mesh, write_mesh
from threedfs.io.volumes import write_support
from threedfs.run_end.export import export
from threedfs.types import Box, Mesh, Plane, Support


@pytest.fixture
def results(tmp_path):
    """Results of a sequence: a ball on a tilted plane."""
    ball = trimesh.creation.icosphere(subdivisions=2)
    write_mesh(tmp_path / "11_object/surface/mesh.ply", Mesh(ball.vertices, ball.faces))
    plane = Plane(np.array([0.6, 0.0, 0.8]), 1.0)
    write_support(
        tmp_path / "03_scene/support.json",
        Support(plane, Box(np.eye(3), -np.ones(3), np.ones(3)), {}),
        {"stage": "test"},
    )
    return tmp_path


@pytest.mark.parametrize("name", ["ball.stl", "ball.ply", "ball.obj", "ball.GLB"])
def test_mesh_has_the_height_given_and_stands_at_zero(results, name):
    export(results, "40", results / name)
    written = read_mesh(results / name).vertices
    assert np.allclose([written[:, 2].min(), written[:, 2].max()], [0, 40], atol=1e-4)


@pytest.mark.parametrize("name", ["ball.ply", "ball.glb", "ball.obj"])
def test_colours_of_vertices_stay(results, name):
    path = results / "11_object/surface/mesh.ply"
    mesh = read_mesh(results / "11_object/surface/mesh.ply")
    colors = np.random.default_rng(0).integers(0, 256, (len(mesh.vertices), 3)).astype(np.uint8)
    write_colored_mesh(path, mesh, colors)
    export(results, "40", results / name, "surface")
    np.testing.assert_array_equal(read_colored_mesh(results / name)[1], colors)


@pytest.mark.parametrize("height", ["tall", "-3", "0", "nan", "inf"])
def test_height_that_is_none_is_refused(results, height):
    with pytest.raises(UserError, match=rf"positive number.* {height}\.$"):
        export(results, height, results / "ball.stl")


def test_format_that_is_not_known_and_mesh_that_is_not_there_are_refused(results):
    with pytest.raises(UserError, match=r"ball\.dwg: expected a file that ends in"):
        export(results, "40", results / "ball.dwg")
    with pytest.raises(UserError, match=r"poisson.*expected the mesh of a run, found none"):
        export(results, "40", results / "ball.stl", "poisson")
    assert not list(results.glob("ball.*"))
