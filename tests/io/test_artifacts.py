"""Round trip, byte identity and rejection, for every artifact that carries a schema."""

from __future__ import annotations

import dataclasses
import importlib
import json
import os
import re
import zipfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from sklearn.mixture import GaussianMixture

from threedfs.errors import UserError
from threedfs.io import schema
from threedfs.io.arrays import open_arrays, writing_arrays
from threedfs.io.consistency import ConsistencyStore, read_consistency
from threedfs.io.documents import read_document, write_document
from threedfs.io.frames import Frame, FrameStore, read_frames, write_frames
from threedfs.io.keyframes import read_keyframe

OTHER = schema.Schema("threedfs/other/1", "other")


def plain(value):
    """Turn a value into nested plain values that compare exactly; NaN equals NaN."""
    if isinstance(value, FrameStore):
        arrays = (value.names, value.indices, value.times, value.sharpness)
        rows = zip(*arrays, (value.image(name) for name in value.names), strict=True)
        return plain([Frame(str(n), int(i), float(t), float(s), image) for n, i, t, s, image in rows])
    if isinstance(value, ConsistencyStore):
        return plain([(name, value.read(name)) for name in value.names])
    if isinstance(value, GaussianMixture):
        return plain([value.weights_, value.means_, value.precisions_cholesky_])
    if isinstance(value, np.ndarray):
        return (value.dtype.str, value.shape, value.tobytes())
    if dataclasses.is_dataclass(value):
        return {field.name: plain(getattr(value, field.name)) for field in dataclasses.fields(value)}
    if isinstance(value, Mapping):
        return [(key, plain(item)) for key, item in value.items()]
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    return value


def test_reading_gives_what_was_written(artifact, header, tmp_path):
    path = tmp_path / artifact.name
    artifact.write(path, artifact.value, header)
    found = artifact.read(path)
    expected = artifact.value
    if artifact.name == "keyframes.json":
        expected = {keyframe.view.name: keyframe for keyframe in expected}
        assert plain(read_keyframe(path, "a")) == plain(expected["a"])
    if artifact.name == "silhouettes.zarr.zip":
        expected = dict(sorted(expected.items()))  # the order in which they are read
    assert plain(found) == plain(expected)


def test_header_is_kept(artifact, header, tmp_path):
    path = tmp_path / artifact.name
    artifact.write(path, artifact.value, header)
    if path.suffix == ".json":
        kept = json.loads(path.read_text())
    else:
        with zipfile.ZipFile(path) as file:
            kept = json.loads(file.read("zarr.json"))["attributes"]
    assert {key: kept[key] for key in header} == header


def test_same_content_has_the_same_bytes(artifact, header, tmp_path):
    paths = [tmp_path / folder / artifact.name for folder in ("first", "second")]
    artifact.write(paths[0], artifact.value, header)
    os.utime(paths[0], (1, 1))
    artifact.write(paths[1], artifact.value, header)
    assert paths[0].read_bytes() == paths[1].read_bytes()


def test_absent_file_is_refused_with_the_rule_that_writes_it(artifact, tmp_path):
    with pytest.raises(UserError, match=f"{artifact.name}.*found none; rule .* writes it"):
        artifact.read(tmp_path / artifact.name)


def test_damaged_file_is_refused(artifact, header, tmp_path):
    path = tmp_path / artifact.name
    artifact.write(path, artifact.value, header)
    path.write_bytes(path.read_bytes()[:-40])  # a zip loses its directory, JSON its end
    with pytest.raises(UserError, match=artifact.name):
        artifact.read(path)


def test_damage_that_shows_when_an_image_is_read_is_told_in_a_sentence(tmp_path, header):
    path = tmp_path / "frames.zarr.zip"
    image = np.random.default_rng(0).integers(0, 255, (40, 50, 3), np.uint8)
    write_frames(path, [Frame("a", 0, 0.0, 1.0, image)], header, ordered=True, source_shape=(40, 50))
    with zipfile.ZipFile(path) as file:
        place = next(entry.header_offset for entry in file.infolist() if entry.filename.startswith("images/c/"))
    damaged = bytearray(path.read_bytes())
    damaged[place + 200] ^= 1
    path.write_bytes(damaged)
    frames = read_frames(path)
    with pytest.raises(UserError, match=r"frames\.zarr\.zip: expected a whole file .*rule frames writes it"):
        frames.image("a")


def test_other_schema_is_refused(artifact, header, tmp_path):
    path = tmp_path / artifact.name
    if path.suffix == ".json":
        write_document(path, OTHER, {}, header)
    else:
        with writing_arrays(path, OTHER, header) as writer:
            writer.put("x", np.zeros(3))
    with pytest.raises(UserError, match=r"expected schema .*, got threedfs/other/1"):
        artifact.read(path)


def test_every_schema_names_rules_that_there_are():
    modules = (
        importlib.import_module(f"threedfs.io.{path.stem}") for path in Path(schema.__file__).parent.glob("*.py")
    )
    found = {value for module in modules for value in vars(module).values() if isinstance(value, schema.Schema)}
    assert len({kind.name for kind in found}) == len(found) > 15
    named = {name for kind in found for name in re.split(r",| or ", kind.rules)}
    texts = (path.read_text() for path in (Path(__file__).parents[2] / "workflow/rules").glob("*.smk"))
    rules = {name for text in texts for name in re.findall(r"^(?:rule|checkpoint) (\w+):", text, re.MULTILINE)}
    assert {name.strip() for name in named} <= rules


def test_failed_writing_leaves_nothing(header, tmp_path):
    with (
        pytest.raises(ZeroDivisionError),
        writing_arrays(tmp_path / "a.zarr.zip", OTHER, header) as writer,
    ):
        writer.put("x", np.zeros(3))
        raise ZeroDivisionError
    assert list(tmp_path.iterdir()) == []


def test_failed_writing_keeps_the_file_that_was_there(header, tmp_path):
    path = tmp_path / "a.json"
    write_document(path, OTHER, {"x": 1}, header)
    with pytest.raises(ValueError, match="JSON"):
        write_document(path, OTHER, {"x": float("nan")}, header)
    assert read_document(path, OTHER)["x"] == 1


def test_zip_has_no_entry_twice_and_no_date(artifact, header, tmp_path):
    path = tmp_path / artifact.name
    if path.suffix != ".zip":
        return
    artifact.write(path, artifact.value, header)
    with zipfile.ZipFile(path) as file:
        names = file.namelist()
        assert len(names) == len(set(names))
        assert {entry.date_time for entry in file.infolist()} == {(1980, 1, 1, 0, 0, 0)}


def test_chunk_equal_to_the_fill_value_is_written(header, tmp_path):
    path = tmp_path / "a.zarr.zip"
    with writing_arrays(path, OTHER, header) as writer:
        writer.put("zeros", np.zeros((4, 4), np.uint8))
        writer.put("missing", np.full((4, 4), np.nan, np.float32))
    with zipfile.ZipFile(path) as file:
        assert {name.partition("/")[0] for name in file.namelist() if "/c/" in name} == {"zeros", "missing"}
    assert np.isnan(open_arrays(path, OTHER)["missing"][...]).all()


def test_frames_are_streamed(header, tmp_path):
    image = np.zeros((4, 4, 3), np.uint8)
    asked = []

    def stream():
        for index in range(5):
            asked.append(index)
            yield Frame(f"{index:06d}", index, index / 30, 1.0, image + index)

    path = tmp_path / "frames.zarr.zip"
    write_frames(path, stream(), header, ordered=False, source_shape=(4, 4), skipped=lambda: len(asked))
    store = read_frames(path)
    assert store.skipped == 5
    assert not store.ordered
    assert store.image("000003").max() == 3


def test_keyframes_may_differ_in_size(artifact, header, tmp_path):
    if artifact.name != "consistency.zarr.zip":
        return
    name, item = artifact.value[0]
    smaller = dataclasses.replace(item, **{key: values[1:] for key, values in vars(item).items()})
    artifact.write(tmp_path / artifact.name, [(name, item), ("b", smaller)], header)
    store = read_consistency(tmp_path / artifact.name)
    for key, values in vars(item).items():
        np.testing.assert_array_equal(getattr(store.read(name), key), values)
        np.testing.assert_array_equal(getattr(store.read("b"), key), values[1:])


def test_unknown_keyframe_is_refused_with_those_there_are(artifact, header, tmp_path):
    if artifact.name != "keyframes.json":
        return
    path = tmp_path / artifact.name
    artifact.write(path, artifact.value, header)
    with pytest.raises(UserError, match="expected a keyframe named z, got a, b"):
        read_keyframe(path, "z")
