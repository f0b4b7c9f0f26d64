"""Exact, property and rejection: volumes as OME-Zarr 0.5, read back with zarr and held to the standard."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
import trimesh
import zarr

from threedfs.cli.main import main
from threedfs.io.meshes import write_mesh
from threedfs.io.volumes import Volume, write_support, write_volume
from threedfs.types import Box, Mesh, Plane, Support, VoxelGrid

SHAPE, SPACING = (70, 41, 36), 0.05
ORIGIN = np.array([-1.0, 0.5, 0.25])
UP = np.array([0.6, 0.0, 0.8])


@pytest.fixture
def results(tmp_path):
    """Results of a sequence: a field on a turned grid, a ball of diameter 2 on a tilted plane."""
    axes = np.array([[0.8, 0.0, -0.6], [0.0, 1.0, 0.0], UP])
    sdf = np.random.default_rng(0).uniform(-1, 1, SHAPE).astype(np.float32)
    grid = VoxelGrid(ORIGIN @ axes, SPACING, SHAPE, axes)
    folder = tmp_path / "mug"
    write_volume(folder / "07_fusion/object.zarr.zip", Volume(grid, sdf, np.ones(SHAPE, np.uint8)), {})
    support = Support(Plane(UP, 1.0), Box(np.eye(3), -np.ones(3), np.ones(3)), {})
    write_support(folder / "03_scene/support.json", support, {})
    ball = trimesh.creation.icosphere(subdivisions=4).apply_transform(trimesh.geometry.align_vectors([0, 0, 1], UP))
    write_mesh(folder / "11_object/surface/mesh.ply", Mesh(ball.vertices, ball.faces))
    return folder, sdf


def check_ome_zarr(path: Path) -> None:
    """Hold a folder to what OME-Zarr 0.5 demands of a multiscale image, and to Zarr 3's metadata."""
    group = json.loads((path / "zarr.json").read_text())
    assert (group["zarr_format"], group["node_type"]) == (3, "group")
    ome = group["attributes"]["ome"]
    assert ome["version"] == "0.5"
    (multiscale,) = ome["multiscales"]
    axes, datasets = multiscale["axes"], multiscale["datasets"]
    assert 2 <= len(axes) <= 5 and len({axis["name"] for axis in axes}) == len(axes)
    assert [axis["name"] for axis in axes if axis["type"] == "space"] == ["z", "y", "x"]
    assert all(axis.get("unit", "meter") == "meter" for axis in axes) and len({str(a.get("unit")) for a in axes}) == 1
    assert isinstance(multiscale["name"], str) and "version" not in multiscale
    sizes, scales = [], []
    for dataset in datasets:
        array = json.loads((path / dataset["path"] / "zarr.json").read_text())
        assert (array["zarr_format"], array["node_type"]) == (3, "array")
        assert array["dimension_names"] == [axis["name"] for axis in axes]
        assert array["chunk_key_encoding"]["configuration"]["separator"] == "/"
        kinds = [transform["type"] for transform in dataset["coordinateTransformations"]]
        assert kinds in (["scale"], ["scale", "translation"])
        for transform in dataset["coordinateTransformations"]:
            values = transform[transform["type"]]
            assert len(values) == len(axes) and all(math.isfinite(value) for value in values)
        scales.append(dataset["coordinateTransformations"][0]["scale"])
        sizes.append(array["shape"])
        assert min(scales[-1]) > 0
    assert len({json.loads((path / d["path"] / "zarr.json").read_text())["data_type"] for d in datasets}) == 1
    assert sizes == sorted(sizes, reverse=True) and scales == sorted(scales)  # from the largest to the smallest
    assert len(list(path.iterdir())) == len(datasets) + 1


def levels_of(path):
    """Read the levels with zarr: values, and the corners of the first and the last voxel's space."""
    group = zarr.open_group(path, mode="r")
    for dataset in group.attrs["ome"]["multiscales"][0]["datasets"]:
        values = group[dataset["path"]][...]
        scale, start = (np.array(t[t["type"]]) for t in dataset["coordinateTransformations"])
        yield values, scale, start


@pytest.mark.parametrize("height", [None, "95mm"])
def test_a_reader_of_zarr_has_the_field_where_it_is(results, tmp_path, height):
    folder, sdf = results
    path = tmp_path / "mug.ome.zarr"
    assert main(["export", str(folder), str(path), *(["--height", height] if height else [])]) == 0
    check_ome_zarr(path)
    metres = 0.095 / 2 if height else 1.0
    (finest, scale, start), *coarser = levels_of(path)
    np.testing.assert_array_equal(finest, sdf.transpose(2, 1, 0))
    assert finest.dtype == np.float32
    np.testing.assert_allclose(scale, SPACING * metres, rtol=1e-3)
    np.testing.assert_allclose(start, ORIGIN[::-1] * metres, rtol=1e-3)
    corner = start - scale / 2
    for _, own, first in coarser:
        np.testing.assert_allclose(first - own / 2, corner, atol=1e-12)  # all levels begin at the same place
    assert [values.shape for values, _, _ in coarser] == [(18, 21, 35), (9, 11, 18)]
    np.testing.assert_allclose(coarser[0][0][3, 4, 5], finest[6:8, 8:10, 10:12].mean(), atol=1e-6)
    unit = zarr.open_group(path, mode="r").attrs["ome"]["multiscales"][0]["axes"][0].get("unit")
    assert unit == ("meter" if height else None)


def test_it_is_replaced_by_the_same_bytes(results, tmp_path):
    path = tmp_path / "mug.ome.zarr"
    written = []
    for _ in range(2):
        assert main(["export", str(results[0]), str(path)]) == 0
        written.append({file.relative_to(path): file.read_bytes() for file in path.rglob("*") if file.is_file()})
    assert written[0] == written[1]
    assert [item.name for item in tmp_path.iterdir() if item.name.startswith(".")] == []


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--faces", "500"], "expected --faces with a mesh"),
        (["--height", "tall"], "expected a length"),
        (["--height", "9cm", "--method", "tsdf"], "expected a mesh by the method tsdf, found one by surface"),
    ],
)
def test_what_cannot_be_is_refused(results, tmp_path, capsys, words, sentence):
    assert main(["export", str(results[0]), str(tmp_path / "mug.zarr"), *words]) == 1
    assert sentence in capsys.readouterr().err
    assert not (tmp_path / "mug.zarr").exists()


def test_a_folder_of_something_else_stays(results, tmp_path, capsys):
    (tmp_path / "mine.zarr").mkdir()
    (tmp_path / "mine.zarr/precious").write_text("mine")
    assert main(["export", str(results[0]), str(tmp_path / "mine.zarr")]) == 1
    assert "expected a new folder" in capsys.readouterr().err
    assert (tmp_path / "mine.zarr/precious").read_text() == "mine"
    assert main(["export", str(tmp_path), str(tmp_path / "new.zarr")]) == 1
    assert "expected the field of a run, found none" in capsys.readouterr().err
