"""Named arrays with attributes in one file: Zarr v3 inside a zip, the same bytes for the same content."""

from __future__ import annotations

import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import zarr
from zarr.codecs import BloscCodec
from zarr.storage import MemoryStore, ZipStore

from threedfs.errors import UserError
from threedfs.io.atomic import atomic
from threedfs.io.schema import Schema, check_schema

_EPOCH = (1980, 1, 1, 0, 0, 0)
_COMPRESSOR = BloscCodec(cname="zstd", clevel=1, shuffle="shuffle", typesize=None)


class ArrayWriter:
    """Fills one zip with arrays, whole or appended item by item, holding only what is not yet written."""

    def __init__(self, file: zipfile.ZipFile, attributes: Mapping[str, Any]) -> None:
        self._zip = file
        self._pending: dict[str, Any] = {}
        self._group = zarr.open_group(MemoryStore(self._pending), mode="w", zarr_format=3)
        self.attributes: dict[str, Any] = dict(attributes)

    def put(self, name: str, data: np.ndarray, chunks: tuple[int, ...] | None = None, **notes: Any) -> None:
        """Write a whole array; `notes` (axes, unit, sign, ...) become its attributes."""
        data = np.ascontiguousarray(data)
        array = self._create(name, data.shape, chunks or data.shape, data.dtype, notes)
        if data.size:
            array[...] = data
        self._flush()

    def append(self, name: str, item: np.ndarray, **notes: Any) -> None:
        """Append one item along the first axis of an array, which the first call creates; one chunk an item."""
        item = np.ascontiguousarray(item)
        if name not in self._group:
            self._create(name, (0, *item.shape), (1, *item.shape), item.dtype, notes)
        array = self._group[name]
        array.resize((array.shape[0] + 1, *item.shape))
        array[-1] = item
        self._flush()

    def finish(self) -> None:
        """Write the metadata, which may have grown with every item."""
        self._group.attrs.update(self.attributes)
        self._flush(everything=True)

    def _create(self, name, shape, chunks, dtype, notes):
        return self._group.create_array(
            name,
            shape=shape,
            chunks=tuple(max(n, 1) for n in chunks),
            dtype=dtype,
            compressors=_COMPRESSOR,
            fill_value=np.nan if np.issubdtype(dtype, np.floating) else 0,
            attributes=notes,
            config={"write_empty_chunks": True},
        )

    def _flush(self, everything: bool = False) -> None:
        for key in sorted(self._pending):
            if everything or not key.endswith("zarr.json"):
                entry = zipfile.ZipInfo(key, date_time=_EPOCH)
                entry.external_attr = 0o644 << 16
                self._zip.writestr(entry, self._pending.pop(key).to_bytes())


@contextmanager
def writing_arrays(path: Path, schema: Schema, header: Mapping[str, Any]) -> Iterator[ArrayWriter]:
    """Open an artifact for writing; it appears under its name only when the block ends well.

    Parameters
    ----------
    path : Path
    schema : Schema
    header : mapping
        Parameters and provenance of the job (`Job.header`).
    """
    with atomic(path) as temporary, zipfile.ZipFile(temporary, "w", zipfile.ZIP_STORED) as file:
        writer = ArrayWriter(file, {"schema": schema.name, **header})
        yield writer
        writer.finish()


class _ArtifactZip(ZipStore):
    """The zip of an artifact: whoever reads a damaged part of it, now or later, is told so in a sentence."""

    def __init__(self, path: Path, schema: Schema) -> None:
        super().__init__(path, mode="r")
        self._schema = schema

    async def get(self, key, prototype, byte_range=None):
        try:
            return await super().get(key, prototype, byte_range)
        except (zipfile.BadZipFile, EOFError) as fault:
            raise _say_damaged(self.path, self._schema, fault) from fault


def _say_damaged(path: Path, schema: Schema, fault: Exception) -> UserError:
    return UserError(
        f"{path}: expected a whole file of schema {schema.name}, got a damaged one ({fault}); "
        f"delete it and run again, rule {schema.rules} writes it."
    )


def open_arrays(path: Path, schema: Schema) -> zarr.Group:
    """Open an artifact for reading; chunks are read when indexed.

    Raises
    ------
    UserError
        If the file is missing, is no whole zip, or has another schema; when indexed, if what is read is damaged.
    """
    path = Path(path)
    if not path.is_file():
        raise UserError(f"{path}: expected a file of schema {schema.name}, found none; rule {schema.rules} writes it.")
    try:
        group = zarr.open_group(_ArtifactZip(path, schema), mode="r", zarr_format=3)
    except (zipfile.BadZipFile, FileNotFoundError, ValueError) as fault:
        raise _say_damaged(path, schema, fault) from fault
    check_schema(path, group.attrs.get("schema"), schema)
    return group


def write_arrays(
    path: Path,
    schema: Schema,
    arrays: Mapping[str, np.ndarray],
    header: Mapping[str, Any],
    notes: Mapping[str, Mapping[str, Any]] | None = None,
    **attributes: Any,
) -> None:
    """Write whole arrays; `notes[name]` are the attributes of one array, `attributes` those of the artifact."""
    with writing_arrays(path, schema, {**header, **attributes}) as writer:
        for name, data in arrays.items():
            writer.put(name, data, **dict((notes or {}).get(name, {})))


def read_arrays(path: Path, schema: Schema) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """Read all arrays of an artifact and its attributes."""
    group = open_arrays(path, schema)
    return {name: np.asarray(array[...]) for name, array in group.arrays()}, dict(group.attrs)
