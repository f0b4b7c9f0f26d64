"""How the object, its background and the support surface look."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from threedfs.io.arrays import read_arrays, write_arrays
from threedfs.io.schema import Schema
from threedfs.segment.appearance import Appearance
from threedfs.segment.color_model import ColorModel
from threedfs.segment.mixture import Mixture
from threedfs.segment.table import TablePicture

APPEARANCE = Schema("threedfs/appearance/1", "segment")

_MIXTURE = tuple(Mixture.__dataclass_fields__)
_SIDES = ("of_object", "of_background")
_TABLE = tuple(TablePicture.__dataclass_fields__)


def write_appearance(path: Path, appearance: Appearance, header: Mapping[str, Any]) -> None:
    """Write the mixtures' weights, means and Cholesky factors of precisions, and the picture of the table, if any."""
    arrays = {f"{side}_{name}": getattr(getattr(appearance.colors, side), name) for side in _SIDES for name in _MIXTURE}
    if appearance.table is not None:
        arrays |= {f"table_{name}": getattr(appearance.table, name) for name in _TABLE}
    write_arrays(path, APPEARANCE, arrays, header)


def read_appearance(path: Path) -> Appearance:
    """Read what `write_appearance` wrote."""
    arrays, _ = read_arrays(path, APPEARANCE)
    sides = (Mixture(**{name: arrays[f"{side}_{name}"] for name in _MIXTURE}) for side in _SIDES)
    has_table = f"table_{_TABLE[0]}" in arrays
    table = TablePicture(**{name: arrays[f"table_{name}"] for name in _TABLE}) if has_table else None
    return Appearance(ColorModel(*sides), table)
