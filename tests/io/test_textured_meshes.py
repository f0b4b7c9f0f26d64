"""Round trip, contract and rejection: meshes with a picture on them."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from threedfs.errors import UserError
from threedfs.io.meshes import read_mesh, write_mesh
from threedfs.io.textured_meshes import read_textured_obj, write_textured_glb, write_textured_obj
from threedfs.texture.textured import TexturedMesh
from threedfs.types import Mesh


@pytest.fixture
def box() -> TexturedMesh:
    """A closed box whose six sides lie apart in a picture of noise, higher than wide."""
    made = trimesh.creation.box((1.0, 2.0, 3.0))
    mesh = Mesh(np.asarray(made.vertices, np.float64), np.asarray(made.faces, np.int64))
    sides = np.abs(made.face_normals).argmax(axis=1)
    flat = np.stack(
        [np.delete(mesh.vertices[face], side, axis=1) for face, side in zip(mesh.faces, sides, strict=True)]
    )
    chart = 2 * sides + (made.face_normals.sum(axis=1) > 0)
    corners = 8.25 + 4 * flat + np.stack([18 * (chart % 2), 15 * (chart // 2)], axis=1)[:, None]
    image = np.random.default_rng(4).integers(0, 256, (52, 40, 3), np.uint8)
    return TexturedMesh(mesh, corners, image)


def test_an_obj_comes_back(box, tmp_path):
    """Round trip: corners to a ten-thousandth of a texel, texels exactly, faces in their order."""
    write_textured_obj(tmp_path / "mesh.obj", box)
    found = read_textured_obj(tmp_path / "mesh.obj")
    np.testing.assert_array_equal(found.image, box.image)
    np.testing.assert_allclose(found.corners, box.corners, atol=1e-4)
    np.testing.assert_allclose(found.mesh.vertices[found.mesh.faces], box.mesh.vertices[box.mesh.faces], atol=1e-8)


def test_an_obj_names_its_material_and_that_its_picture(box, tmp_path):
    """Contract: three files of one name, whatever it is, that are read again where they are put together."""
    write_textured_obj(tmp_path / "my mug.2.obj", box)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["my mug.2.mtl", "my mug.2.obj", "my mug.2.png"]
    assert "mtllib my mug.2.mtl" in (tmp_path / "my mug.2.obj").read_text().splitlines()
    assert "map_Kd my mug.2.png" in (tmp_path / "my mug.2.mtl").read_text().splitlines()
    moved = tmp_path.rename(tmp_path.with_name("moved"))
    np.testing.assert_array_equal(read_textured_obj(moved / "my mug.2.obj").image, box.image)


@pytest.mark.parametrize("kind", ["obj", "glb"])
def test_the_same_mesh_has_the_same_bytes(box, tmp_path, kind):
    write = {"obj": write_textured_obj, "glb": write_textured_glb}[kind]
    for name in "ab":
        (tmp_path / name).mkdir()
        write(tmp_path / name / f"mesh.{kind}", box)
    first, second = (sorted((tmp_path / name).iterdir()) for name in "ab")
    assert [path.read_bytes() for path in first] == [path.read_bytes() for path in second]


@pytest.mark.parametrize("ending", ["png", "mtl"])
def test_an_obj_whose_picture_or_material_is_gone_is_refused(box, tmp_path, ending):
    """Rejection: rather than painted grey."""
    write_textured_obj(tmp_path / "mesh.obj", box)
    (tmp_path / f"mesh.{ending}").unlink()
    with pytest.raises(UserError, match=r"mesh\.obj: expected a mesh with a texture, found none.*\.mtl and \.png"):
        read_textured_obj(tmp_path / "mesh.obj")


def test_an_obj_without_a_picture_or_none_at_all_is_refused(box, tmp_path):
    write_mesh(tmp_path / "plain.obj", box.mesh)
    with pytest.raises(UserError, match="expected a mesh with a texture"):
        read_textured_obj(tmp_path / "plain.obj")
    with pytest.raises(UserError, match="expected a mesh file, found none"):
        read_textured_obj(tmp_path / "absent.obj")


@pytest.mark.parametrize("kind", ["obj", "glb"])
def test_other_programs_find_the_picture_where_it_belongs(box, tmp_path, kind):
    """Contract: u to the right, v up, both in [0, 1]; the texel at a corner is the one that was meant."""
    path = tmp_path / f"mesh.{kind}"
    {"obj": write_textured_obj, "glb": write_textured_glb}[kind](path, box)
    found = trimesh.load(path, force="mesh", process=False)
    uv = np.asarray(found.visual.uv)
    assert uv.min() >= 0 and uv.max() <= 1
    material = found.visual.material
    picture = np.asarray((material.image if kind == "obj" else material.baseColorTexture).convert("RGB"))
    np.testing.assert_array_equal(picture, box.image)
    height, width = box.image.shape[:2]
    # glTF counts rows from the top; trimesh turns them round as it reads
    places = np.stack([uv[:, 0] * width - 0.5, (1 - uv[:, 1]) * height - 0.5], axis=1)[found.faces]
    np.testing.assert_allclose(places, box.corners, atol=1e-3)


def test_a_glb_is_dull_and_closed_once_its_corners_are_joined(box, tmp_path):
    """Contract: nothing metallic or shining, as photographs hold their light; no face is lost or turned."""
    write_textured_glb(tmp_path / "mesh.glb", box)
    found = trimesh.load(tmp_path / "mesh.glb", force="mesh", process=False)
    assert found.visual.material.metallicFactor == 0 and found.visual.material.roughnessFactor == 1
    assert len(found.faces) == 12 and len(found.vertices) == 24  # each corner once for each side
    joined = trimesh.Trimesh(found.vertices, found.faces)
    assert joined.is_watertight and joined.volume == pytest.approx(6)
    np.testing.assert_allclose(
        read_mesh(tmp_path / "mesh.glb").vertices[found.faces], box.mesh.vertices[box.mesh.faces]
    )
