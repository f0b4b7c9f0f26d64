"""How the object, its background and the support surface look."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sklearn.mixture import GaussianMixture

from threedfs.io.arrays import read_arrays, write_arrays
from threedfs.io.schema import Schema
from threedfs.segment.appearance import Appearance
from threedfs.segment.color_model import ColorModel
from threedfs.segment.table import TablePicture

APPEARANCE = Schema("threedfs/appearance/1", "segment")

_MIXTURE = ("weights_", "means_", "precisions_cholesky_")
_SIDES = ("of_object", "of_background")
_TABLE = tuple(TablePicture.__dataclass_fields__)


def write_appearance(path: Path, appearance: Appearance, header: Mapping[str, Any]) -> None:
    """Write the mixtures' weights, means and Cholesky factors of precisions, and the picture of the table, if any."""
    arrays = {
        f"{side}_{name.rstrip('_')}": getattr(getattr(appearance.colors, side), name)
        for side in _SIDES
        for name in _MIXTURE
    }
    if appearance.table is not None:
        arrays |= {f"table_{name}": getattr(appearance.table, name) for name in _TABLE}
    write_arrays(path, APPEARANCE, arrays, header)


def read_appearance(path: Path) -> Appearance:
    """Read what `write_appearance` wrote; the mixtures can tell densities, not learn on."""
    arrays, _ = read_arrays(path, APPEARANCE)

    def mixture(side: str) -> GaussianMixture:
        made = GaussianMixture(len(arrays[f"{side}_weights"]))
        for name in _MIXTURE:
            setattr(made, name, arrays[f"{side}_{name.rstrip('_')}"])
        return made

    has_table = f"table_{_TABLE[0]}" in arrays
    table = TablePicture(**{name: arrays[f"table_{name}"] for name in _TABLE}) if has_table else None
    return Appearance(ColorModel(*map(mixture, _SIDES)), table)
