"""Where the object is in a field."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from threedfs.io.arrays import read_arrays, write_arrays
from threedfs.io.grids import describe_grid, grid_of
from threedfs.io.schema import Schema
from threedfs.locate.find import Located
from threedfs.types import Plane

LOCATED = Schema("threedfs/located/1", "locate_object")


def write_located(path: Path, located: Located, header: Mapping[str, Any]) -> None:
    """Write where the object is."""
    write_arrays(
        path,
        LOCATED,
        {"voxels": located.voxels},
        header,
        {"voxels": {"axes": "x, y, z"}},
        **describe_grid(located.grid),
        plane={"normal": located.plane.normal.tolist(), "offset": float(located.plane.offset)},
        least_height=float(located.least_height),
        supported=int(located.supported),
        rivals=int(located.rivals),
    )


def read_located(path: Path) -> Located:
    """Read where the object is."""
    arrays, found = read_arrays(path, LOCATED)
    grid = grid_of(found, arrays["voxels"].shape)
    plane = Plane(np.array(found["plane"]["normal"]), found["plane"]["offset"])
    return Located(grid, plane, arrays["voxels"], found["least_height"], found["supported"], found["rivals"])
