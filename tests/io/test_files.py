"""Round trip and rejection of what has no schema: images, masks, meshes, points, tables."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
import trimesh

from threedfs.errors import UserError
from threedfs.io.colored_meshes import read_colored_mesh, write_colored_mesh
from threedfs.io.images import read_image, read_mask, write_mask, write_png
from threedfs.io.meshes import read_mesh, write_mesh
from threedfs.io.metrics import read_metrics, write_metrics
from threedfs.types import Mesh


@pytest.fixture
def tetrahedron() -> Mesh:
    """The smallest closed mesh."""
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.5]])
    return Mesh(vertices, np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]))


def test_image_comes_back_exactly(tmp_path):
    image = np.random.default_rng(0).integers(0, 256, (5, 7, 3), np.uint8)
    write_png(tmp_path / "a.png", image)
    assert (read_image(tmp_path / "a.png") == image).all()
    assert (cv2.imread(str(tmp_path / "a.png"))[..., ::-1] == image).all()  # RGB, by another's reading


def test_mask_comes_back_exactly_as_black_and_white(tmp_path):
    mask = np.random.default_rng(0).random((5, 7)) > 0.5
    write_mask(tmp_path / "a.png", mask)
    assert (read_mask(tmp_path / "a.png") == mask).all()
    assert set(np.unique(cv2.imread(str(tmp_path / "a.png"), cv2.IMREAD_UNCHANGED))) == {0, 255}


def test_same_image_has_the_same_bytes(tmp_path):
    for name in "ab":
        write_mask(tmp_path / f"{name}.png", np.eye(9, dtype=bool))
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


@pytest.mark.parametrize("read", [read_image, read_mask, read_mesh])
def test_absent_and_unreadable_files_are_refused(read, tmp_path):
    with pytest.raises(UserError, match=r"nothing\.png: expected .*, found none"):
        read(tmp_path / "nothing.png")
    (tmp_path / "text.ply").write_text("no picture, no mesh")
    with pytest.raises(UserError, match=r"text\.ply: expected"):
        read(tmp_path / "text.ply")


def test_mesh_comes_back_with_its_orientation(tetrahedron, tmp_path):
    write_mesh(tmp_path / "a.ply", tetrahedron)
    found = read_mesh(tmp_path / "a.ply")
    assert np.abs(found.vertices - tetrahedron.vertices).max() < 1e-7  # PLY holds float32
    assert (found.faces == tetrahedron.faces).all()
    # counter-clockwise from outside: the volume is positive, one sixth of 1 x 1 x 1.5
    assert trimesh.load(tmp_path / "a.ply").volume == pytest.approx(0.25)


def test_same_mesh_has_the_same_bytes(tetrahedron, tmp_path):
    for name in "ab":
        write_mesh(tmp_path / f"{name}.ply", tetrahedron)
    assert (tmp_path / "a.ply").read_bytes() == (tmp_path / "b.ply").read_bytes()


def test_colours_and_other_properties_of_vertices_are_in_a_ply(tetrahedron, tmp_path):
    """Exact: by another's reading; without the properties the colours are the same."""
    colors = np.random.default_rng(0).integers(0, 256, (4, 3), np.uint8)
    confirmed = np.array([0, 0.25, 0.75, 1], np.float32)
    write_colored_mesh(tmp_path / "a.ply", tetrahedron, colors, {"confirmed": confirmed})
    write_colored_mesh(tmp_path / "b.ply", tetrahedron, colors)
    assert b"property float confirmed\n" in (tmp_path / "a.ply").read_bytes()
    assert b"confirmed" not in (tmp_path / "b.ply").read_bytes()
    found = trimesh.load(tmp_path / "a.ply", process=False)
    np.testing.assert_array_equal(found.metadata["_ply_raw"]["vertex"]["data"]["confirmed"], confirmed)
    for name in "ab":
        mesh, read = read_colored_mesh(tmp_path / f"{name}.ply")
        np.testing.assert_array_equal(read, colors)
        np.testing.assert_array_equal(mesh.faces, tetrahedron.faces)
        assert np.abs(mesh.vertices - tetrahedron.vertices).max() < 1e-7


def test_metrics_come_back(figures, tmp_path):
    write_metrics(tmp_path / "a.csv", figures)
    assert read_metrics(tmp_path / "a.csv") == figures
    assert (tmp_path / "a.csv").read_text().splitlines()[0] == "name,value,unit,dataset,sequence,method,keyframe"


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("name,value\n", "expected the columns name,value,unit,dataset"),
        ("name,value,unit,dataset,sequence,method,keyframe\niou,much,1,,,,\n", "a number as value in line 2"),
        ("name,value,unit,dataset,sequence,method,keyframe\niou,1\n", "expected 7 columns"),
    ],
)
def test_other_tables_are_refused(text, sentence, tmp_path):
    (tmp_path / "a.csv").write_text(text)
    with pytest.raises(UserError, match=sentence):
        read_metrics(tmp_path / "a.csv")


def test_absent_table_is_refused(tmp_path):
    with pytest.raises(UserError, match="expected a table of metrics, found none"):
        read_metrics(tmp_path / "a.csv")
