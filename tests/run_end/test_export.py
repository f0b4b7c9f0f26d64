"""Writing an object's mesh for other programs."""

from __future__ import annotations

import shutil

import numpy as np
import pytest
import trimesh

from threedfs.errors import UserError
from threedfs.io.colored_meshes import read_colored_mesh, write_colored_mesh
from threedfs.io.meshes import read_mesh, write_mesh
from threedfs.io.scales import Scale, write_scale
from threedfs.io.textured_meshes import read_textured_obj, write_textured_obj
from threedfs.io.volumes import write_support
from threedfs.run_end.export import export
from threedfs.run_end.results import open_results
from threedfs.texture.textured import TexturedMesh
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


@pytest.fixture
def painted(results):
    """The same, with an egg in a folder of textures, for to tell the two apart: it is larger."""
    egg = trimesh.creation.icosphere(subdivisions=1, radius=1.5)
    mesh = Mesh(np.asarray(egg.vertices), np.asarray(egg.faces, np.int64))
    generator = np.random.default_rng(0)
    image = generator.integers(0, 256, (16, 24, 3), np.uint8)
    textured = TexturedMesh(mesh, generator.uniform(0, 15, (len(mesh.faces), 3, 2)), image)
    write_textured_obj(results / "11_object/surface/textured/mesh.obj", textured)
    return results


def check_stands(path, up):
    """Check that a mesh is 40 high, stands at 0, and over the origin."""
    written = read_mesh(path).vertices
    low, high = written.min(axis=0), written.max(axis=0)
    assert np.allclose([low[up], high[up]], [0, 40], atol=1e-4)
    level = [axis for axis in range(3) if axis != up]
    assert np.allclose((low + high)[level], 0, atol=1e-4)


@pytest.mark.parametrize(("name", "up"), [("ball.stl", 2), ("ball.ply", 2), ("ball.obj", 2), ("ball.GLB", 1)])
def test_mesh_has_the_height_given_and_stands_at_zero(results, name, up):
    """Exact: z is up, and in GLB y, as its readers expect."""
    export(results, "40", results / name)
    check_stands(results / name, up)


@pytest.mark.parametrize(("name", "up"), [("ball.obj", 2), ("ball.glb", 1), ("my ball.OBJ", 2)])
def test_a_texture_goes_along_where_the_format_has_one(painted, name, up):
    """Exact: the picture is the one of the run, and the mesh that which it was painted on."""
    export(painted, "40", painted / name)
    check_stands(painted / name, up)
    found = trimesh.load(painted / name, force="mesh", process=False)
    material = found.visual.material
    picture = material.image if up == 2 else material.baseColorTexture
    original = read_textured_obj(painted / "11_object/surface/textured/mesh.obj").image
    np.testing.assert_array_equal(np.asarray(picture.convert("RGB")), original)
    joined = trimesh.Trimesh(found.vertices, found.faces)
    assert len(joined.faces) == 80 and joined.is_watertight and joined.volume > 0


@pytest.mark.parametrize("name", ["ball.stl", "ball.ply"])
def test_formats_without_a_texture_have_the_full_mesh_as_before(painted, name):
    """Exact: the bytes are those of a run without one."""
    export(painted, "40", painted / name)
    with_texture = (painted / name).read_bytes()
    assert len(read_mesh(painted / name).faces) == 320
    shutil.rmtree(painted / "11_object/surface/textured")
    export(painted, "40", painted / name)
    assert (painted / name).read_bytes() == with_texture


def test_a_method_without_a_texture_has_its_own_mesh(painted):
    shutil.copytree(painted / "11_object/surface", painted / "11_object/poisson")
    shutil.rmtree(painted / "11_object/poisson/textured")
    export(painted, "40", painted / "ball.glb", "poisson")
    assert trimesh.load(painted / "ball.glb", force="mesh").visual.kind != "texture"


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


@pytest.mark.parametrize(("name", "up", "height"), [("ball.stl", 2, 500.0), ("ball.glb", 1, 0.5)])
def test_the_scale_of_a_run_is_that_of_its_exports(results, name, up, height):
    """Exact: a ball two units tall, of a quarter of a metre each; millimetres, GLB in metres."""
    write_scale(results / "11_object/scale.json", Scale(0.25, 0.004, "tag", 0.04, 9, "4x4 1"), {})
    tall = float(np.ptp(read_mesh(results / "11_object/surface/mesh.ply").vertices @ [0.6, 0.0, 0.8]))
    assert export(results, None, results / name) == pytest.approx(height * tall / 2)
    assert np.ptp(read_mesh(results / name).vertices[:, up]) == pytest.approx(height * tall / 2, rel=1e-5)
    assert open_results_of(results).scale().metres_per_unit == 0.25


def test_an_export_without_any_size_is_refused(results):
    with pytest.raises(UserError, match=r"expected --height.*--tag, --board or --height.*found neither"):
        export(results, None, results / "ball.stl")
    assert not (results / "ball.stl").exists()


def open_results_of(folder):
    """Open results as a user does."""
    (folder / "02_poses").mkdir()
    return open_results(folder)
