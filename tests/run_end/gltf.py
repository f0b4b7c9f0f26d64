"""A strict reader of binary glTF 2.0, which shares nothing with the writer."""

from __future__ import annotations

import io
import json
import struct
from pathlib import Path

import numpy as np
from PIL import Image

_DTYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
_TRIANGLES = 4


class NotGltf(Exception):
    """What is wrong with a file."""


def demand(true: bool, what: str) -> None:
    """Raise `NotGltf` unless something holds."""
    if not true:
        raise NotGltf(what)


def read_glb(path: Path) -> list[dict[str, np.ndarray]]:
    """Return the arrays of each primitive by the names of its attributes, `indices` and `image` among them.

    Raises
    ------
    NotGltf
        If the file breaks a rule of the standard that is looked at here.
    """
    document, binary = _read_chunks(path.read_bytes())
    demand(document["asset"]["version"] == "2.0", "asset.version")
    (buffer,) = document["buffers"]
    demand("uri" not in buffer, "the buffer of a GLB has no address")
    demand(0 <= len(binary) - buffer["byteLength"] <= 3, "length of the buffer")
    for view in document["bufferViews"]:
        start = view.get("byteOffset", 0)
        demand(view["buffer"] == 0 and view["byteLength"] > 0, "buffer view")
        demand(0 <= start and start + view["byteLength"] <= buffer["byteLength"], "buffer view out of the buffer")
    arrays = [_read_accessor(document, binary, accessor) for accessor in document["accessors"]]
    _check_nodes(document)
    found = []
    for mesh in document["meshes"]:
        for primitive in mesh["primitives"]:
            found.append(_read_primitive(document, binary, arrays, primitive))
    return found


def _read_chunks(data: bytes) -> tuple[dict, bytes]:
    magic, version, length = struct.unpack_from("<4sII", data)
    demand(magic == b"glTF" and version == 2, "header")
    demand(length == len(data), "length in the header")
    chunks, place = [], 12
    while place < length:
        size, kind = struct.unpack_from("<I4s", data, place)
        demand(size % 4 == 0 and place + 8 + size <= length, "chunk")
        chunks.append((kind, data[place + 8 : place + 8 + size]))
        place += 8 + size
    demand([kind for kind, _ in chunks] == [b"JSON", b"BIN\0"], "chunks are JSON, then BIN")
    return json.loads(chunks[0][1].decode("utf-8")), chunks[1][1]


def _read_accessor(document: dict, binary: bytes, accessor: dict) -> np.ndarray:
    demand(accessor["count"] > 0 and accessor["componentType"] in _DTYPES, "accessor")
    view = document["bufferViews"][accessor["bufferView"]]
    dtype, width = np.dtype(_DTYPES[accessor["componentType"]]), _WIDTHS[accessor["type"]]
    offset = accessor.get("byteOffset", 0)
    stride = view.get("byteStride", dtype.itemsize * width)
    demand((view.get("byteOffset", 0) + offset) % dtype.itemsize == 0, "alignment")
    demand(
        offset + stride * (accessor["count"] - 1) + dtype.itemsize * width <= view["byteLength"], "accessor too long"
    )
    start = view.get("byteOffset", 0) + offset
    values = np.ndarray((accessor["count"], width), dtype, binary, start, (stride, dtype.itemsize))
    demand(bool(np.isfinite(values).all()), "values that are no numbers")
    for name, bound in (("min", values.min(axis=0)), ("max", values.max(axis=0))):
        if name in accessor:
            demand(np.array_equal(np.asarray(accessor[name], dtype).ravel(), bound), f"{name} of an accessor")
    return values


def _check_nodes(document: dict) -> None:
    scene = document["scenes"][document.get("scene", 0)]
    reached, waiting = [], list(scene["nodes"])
    while waiting:
        node = waiting.pop()
        demand(0 <= node < len(document["nodes"]) and node not in reached, "nodes are no tree")
        reached.append(node)
        waiting += document["nodes"][node].get("children", [])
    shown = {document["nodes"][node].get("mesh") for node in reached} - {None}
    demand(shown == set(range(len(document["meshes"]))), "a mesh that no node shows")


def _read_primitive(document: dict, binary: bytes, arrays: list[np.ndarray], primitive: dict) -> dict[str, np.ndarray]:
    demand(primitive.get("mode", _TRIANGLES) == _TRIANGLES, "triangles")
    places = primitive["attributes"]
    position = document["accessors"][places["POSITION"]]
    demand(position["type"] == "VEC3" and position["componentType"] == 5126, "positions")
    demand("min" in position and "max" in position, "bounds of the positions")
    found = {name: arrays[place] for name, place in places.items()}
    demand(all(len(values) == position["count"] for values in found.values()), "attributes of one length")
    indices = document["accessors"][primitive["indices"]]
    demand(indices["type"] == "SCALAR" and indices["componentType"] in (5121, 5123, 5125), "indices")
    demand(indices["count"] % 3 == 0, "whole triangles")
    found["indices"] = arrays[primitive["indices"]].ravel()
    demand(int(found["indices"].max()) < position["count"], "an index out of range")
    if "TEXCOORD_0" in found:
        places = found["TEXCOORD_0"]
        demand(places.shape[1] == 2 and places.min() >= 0 and places.max() <= 1, "places outside of the picture")
        found["image"] = _read_image(document, binary, primitive)
    return found


def _read_image(document: dict, binary: bytes, primitive: dict) -> np.ndarray:
    material = document["materials"][primitive["material"]]
    texture = document["textures"][material["pbrMetallicRoughness"]["baseColorTexture"]["index"]]
    image = document["images"][texture["source"]]
    view = document["bufferViews"][image["bufferView"]]
    data = binary[view.get("byteOffset", 0) :][: view["byteLength"]]
    with Image.open(io.BytesIO(data)) as opened:
        demand(image["mimeType"] == f"image/{opened.format.lower()}", "kind of the image")
        return np.asarray(opened.convert("RGB"))
