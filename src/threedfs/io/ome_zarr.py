"""Volumes as OME-Zarr 0.5 (OME-NGFF): a folder that image viewers and any reader of Zarr 3 open."""

from __future__ import annotations

import os
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import zarr
from zarr.codecs import BloscCodec

from threedfs.errors import UserError

_AXES = ("z", "y", "x")
_CHUNK = 64
_SMALLEST = 32
"""Voxels along the longest side of the coarsest level."""
_COMPRESSOR = BloscCodec(cname="zstd", clevel=5, shuffle="shuffle", typesize=None)


def write_ome_zarr(
    path: Path,
    volume: np.ndarray,
    spacing: float,
    origin: Sequence[float],
    unit: str | None,
    name: str,
    notes: Mapping[str, Any],
) -> None:
    """Write a volume with coarser and coarser levels, each the mean of 2 x 2 x 2 voxels of the one before.

    Parameters
    ----------
    path : Path
        A folder, which is replaced if it is OME-Zarr.
    volume : (nx, ny, nz) float32
        Written as z, y, x.
    spacing : float
        Edge of a voxel.
    origin : sequence of float
        x, y and z of the centre of voxel (0, 0, 0).
    unit : str, optional
        Of spacing and origin, as OME-Zarr spells it: "meter". Without it, lengths have no unit.
    name : str
    notes : mapping
        What else is to be known of the values; an attribute beside the standard's.

    Raises
    ------
    UserError
        If something else is in the way.
    """
    if path.exists() and not (path / "zarr.json").is_file():
        raise UserError(f"{path}: expected a new folder to write OME-Zarr to, found something else; use another name.")
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
    temporary.parent.mkdir(parents=True, exist_ok=True)
    shutil.rmtree(temporary, ignore_errors=True)
    try:
        group = zarr.open_group(temporary, mode="w", zarr_format=3)
        datasets: list[dict[str, Any]] = []
        level = np.ascontiguousarray(volume.T, np.float32)
        while True:
            number = len(datasets)
            _put(group, str(number), level)
            factor = 2.0**number
            first = [float(start + spacing * (factor - 1) / 2) for start in reversed(list(origin))]
            datasets.append(
                {
                    "path": str(number),
                    "coordinateTransformations": [
                        {"type": "scale", "scale": [float(spacing * factor)] * 3},
                        {"type": "translation", "translation": first},
                    ],
                }
            )
            if max(level.shape) <= _SMALLEST:
                break
            level = _halve(level)
        axes = [{"name": axis, "type": "space", **({"unit": unit} if unit else {})} for axis in _AXES]
        multiscale = {"name": name, "axes": axes, "datasets": datasets, "type": "mean"}
        group.attrs.update({"ome": {"version": "0.5", "multiscales": [multiscale]}, "threedfs": dict(notes)})
        if path.exists():
            shutil.rmtree(path)
        os.replace(temporary, path)
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def _put(group: zarr.Group, name: str, values: np.ndarray) -> None:
    array = group.create_array(
        name,
        shape=values.shape,
        chunks=tuple(min(_CHUNK, side) for side in values.shape),
        dtype=values.dtype,
        compressors=_COMPRESSOR,
        dimension_names=_AXES,
        fill_value=1.0,
    )
    array[...] = values


def _halve(values: np.ndarray) -> np.ndarray:
    """Return means of 2 x 2 x 2 values; a side of odd length repeats its last ones."""
    padded = np.pad(values, [(0, side % 2) for side in values.shape], mode="edge")
    deep, high, wide = (side // 2 for side in padded.shape)
    return padded.reshape(deep, 2, high, 2, wide, 2).mean(axis=(1, 3, 5), dtype=np.float64).astype(np.float32)
