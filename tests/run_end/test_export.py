"""Writing an object's mesh for other programs."""

from __future__ import annotations

import shutil

import numpy as np
import pytest
import trimesh
from gltf import NotGltf, read_glb

from threedfs.cli.main import main
from threedfs.errors import UserError
from threedfs.io.colored_meshes import read_colored_mesh, write_colored_mesh
from threedfs.io.meshes import read_mesh, write_mesh
from threedfs.io.scales import Scale, write_scale
from threedfs.io.textured_meshes import read_textured_obj, write_textured_obj
from threedfs.io.volumes import write_support
from threedfs.run_end.export import export, export_levels
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
    export(results, 40.0, results / name)
    check_stands(results / name, up)


@pytest.mark.parametrize(("name", "up"), [("ball.obj", 2), ("ball.glb", 1), ("my ball.OBJ", 2)])
def test_a_texture_goes_along_where_the_format_has_one(painted, name, up):
    """Exact: the picture is the one of the run, and the mesh that which it was painted on."""
    export(painted, 40.0, painted / name)
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
    export(painted, 40.0, painted / name)
    with_texture = (painted / name).read_bytes()
    assert len(read_mesh(painted / name).faces) == 320
    shutil.rmtree(painted / "11_object/surface/textured")
    export(painted, 40.0, painted / name)
    assert (painted / name).read_bytes() == with_texture


def test_a_method_without_a_texture_has_its_own_mesh(painted):
    shutil.copytree(painted / "11_object/surface", painted / "11_object/poisson")
    shutil.rmtree(painted / "11_object/poisson/textured")
    export(painted, 40.0, painted / "ball.glb", "poisson")
    assert trimesh.load(painted / "ball.glb", force="mesh").visual.kind != "texture"


@pytest.mark.parametrize("name", ["ball.ply", "ball.glb", "ball.obj"])
def test_colours_of_vertices_stay(results, name):
    path = results / "11_object/surface/mesh.ply"
    mesh = read_mesh(results / "11_object/surface/mesh.ply")
    colors = np.random.default_rng(0).integers(0, 256, (len(mesh.vertices), 3)).astype(np.uint8)
    write_colored_mesh(path, mesh, colors)
    export(results, 40.0, results / name, "surface")
    np.testing.assert_array_equal(read_colored_mesh(results / name)[1], colors)


@pytest.mark.parametrize("height", [-3.0, 0.0, float("nan"), float("inf")])
def test_height_that_is_none_is_refused(results, height):
    with pytest.raises(UserError, match=rf"positive number.* {height}\.$"):
        export(results, height, results / "ball.stl")


def test_format_that_is_not_known_and_mesh_that_is_not_there_are_refused(results):
    with pytest.raises(UserError, match=r"ball\.dwg: expected a file that ends in"):
        export(results, 40.0, results / "ball.dwg")
    with pytest.raises(UserError, match=r"expected a mesh by the method poisson, found one by surface"):
        export(results, 40.0, results / "ball.stl", "poisson")
    assert not list(results.glob("ball.*"))


def test_a_textured_glb_keeps_to_the_standard(painted):
    """Exact: read without trimesh, it is the mesh and the picture; v points down in glTF."""
    export(painted, 40.0, painted / "ball.glb")
    (found,) = read_glb(painted / "ball.glb")
    original = read_textured_obj(painted / "11_object/surface/textured/mesh.obj")
    np.testing.assert_array_equal(found["image"], original.image)
    assert len(found["indices"]) == 3 * 80
    by_trimesh = trimesh.load(painted / "ball.glb", force="mesh", process=False)
    np.testing.assert_array_equal(found["indices"].reshape(-1, 3), by_trimesh.faces)
    np.testing.assert_allclose(found["POSITION"], by_trimesh.vertices, atol=1e-6)
    height, width = original.image.shape[:2]
    texels = found["TEXCOORD_0"][found["indices"]].reshape(-1, 3, 2) * [width, height] - 0.5
    np.testing.assert_allclose(np.sort(texels, axis=None), np.sort(original.corners, axis=None), atol=1e-3)


def test_a_coloured_glb_keeps_to_the_standard(results):
    path = results / "11_object/surface/mesh.ply"
    mesh = read_mesh(path)
    colors = np.random.default_rng(0).integers(0, 256, (len(mesh.vertices), 3)).astype(np.uint8)
    write_colored_mesh(path, mesh, colors)
    export(results, 40.0, results / "ball.glb")
    (found,) = read_glb(results / "ball.glb")
    np.testing.assert_array_equal(found["COLOR_0"][:, :3], colors)
    assert found["POSITION"][:, 1].min() == pytest.approx(0, abs=1e-5)


@pytest.mark.parametrize(
    ("old", "new", "what"),
    [
        (b'"count":240', b'"count":999', "accessor too long"),
        (b"glTF\x02", b"glTF\x01", "header"),
        (b'"POSITION":', b'"POSITIVE":', "POSITION"),
    ],
)
def test_the_reader_of_glb_finds_faults(painted, old, new, what):
    export(painted, 40.0, painted / "ball.glb")
    data = (painted / "ball.glb").read_bytes()
    assert old in data
    (painted / "ball.glb").write_bytes(data.replace(old, new))
    with pytest.raises((NotGltf, KeyError), match=what):
        read_glb(painted / "ball.glb")


def test_the_reader_of_glb_finds_an_index_out_of_range(painted):
    export(painted, 40.0, painted / "ball.glb")
    data = bytearray((painted / "ball.glb").read_bytes())
    indices = read_glb(painted / "ball.glb")[0]["indices"]
    place = data.index(indices.tobytes())
    data[place : place + indices.itemsize] = np.array([60000], indices.dtype).tobytes()
    (painted / "ball.glb").write_bytes(data)
    with pytest.raises(NotGltf):
        read_glb(painted / "ball.glb")


@pytest.fixture
def fine(results):
    """The ball with 81920 faces, white above and black below."""
    ball = trimesh.creation.icosphere(subdivisions=6)
    colors = np.where(ball.vertices[:, 2:] > 0, 255, 0).repeat(3, axis=1).astype(np.uint8)
    write_colored_mesh(results / "11_object/surface/mesh.ply", Mesh(ball.vertices, ball.faces), colors)
    return results


def test_levels_of_detail_are_closed_and_tell_their_error(fine):
    """Property: a ball of diameter 40 keeps its height; ten times the faces leave a tenth of the error."""
    height, levels = export_levels(fine, 40.0, fine / "ball.stl", [1000, 10000])
    assert height == 40.0
    assert [path.name for path in levels] == ["ball_1000.stl", "ball_10000.stl"]
    for count, (path, level) in zip((1000, 10000), levels.items(), strict=True):
        found = trimesh.load(path)
        assert 0.7 * count < len(found.faces) <= count and len(found.faces) == len(level.mesh.faces)
        assert found.bounds[:, 2] == pytest.approx([0, 40.0], abs=1e-5)
        assert found.is_watertight and found.volume == pytest.approx(4 / 3 * np.pi * 20**3, rel=20 / count)
        assert 0 < level.mean_error < level.largest_error < 0.6
    coarse, near = levels.values()
    assert 5 < coarse.mean_error / near.mean_error < 20


def test_levels_have_the_colours_of_the_mesh_and_one_has_the_name_given(fine):
    export_levels(fine, 0.04, fine / "ball.glb", [2000])
    (found,) = read_glb(fine / "ball.glb")
    dark = found["COLOR_0"][:, 0] == 0
    assert 0.3 < dark.mean() < 0.7 and set(np.unique(found["COLOR_0"][:, :3])) == {0, 255}
    assert found["POSITION"][:, 1].max() == pytest.approx(0.04, rel=1e-6)


def test_a_mesh_with_few_faces_stays_what_it_is(results):
    _, levels = export_levels(results, 40.0, results / "ball.stl", [5000])
    export(results, 40.0, results / "full.stl")
    assert (results / "ball.stl").read_bytes() == (results / "full.stl").read_bytes()
    assert levels[results / "ball.stl"].largest_error == 0


def test_a_mesh_with_a_hole_has_no_levels(results):
    path = results / "11_object/surface/mesh.ply"
    mesh = read_mesh(path)
    write_mesh(path, Mesh(mesh.vertices, mesh.faces[1:]))
    with pytest.raises(UserError, match="expected a closed mesh"):
        export_levels(results, 40.0, results / "ball.stl", [100])
    assert not list(results.glob("ball*"))


def test_the_command_tells_faces_and_error_and_refuses_none(fine, capsys):
    words = ["export", str(fine), str(fine / "ball.stl"), "--height", "40mm", "--faces"]
    assert main([*words, "500,4000"]) == 0
    told = capsys.readouterr().out.splitlines()
    assert len(told) == 2 and all("faces, closed, 40 mm tall; the full mesh is" in line for line in told)
    for wrong in ("99", "many", "500,", "-500"):
        with pytest.raises(SystemExit):
            main([*words, wrong])
        assert "expected whole numbers of at least 100" in capsys.readouterr().err


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
