"""Parameters of the locate_object stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.component import ComponentSettings
from threedfs.params.field import parameter


@dataclass(frozen=True)
class LocateObjectParams(ComponentSettings):
    """How the object is separated from the rest of a field."""

    clearance: float = parameter(
        1.5,
        "least height above the plane from which voxels may belong to the object, in the scene and on its own grid",
        unit="voxel",
        symbol="tau",
        equation="Sec. 3.4.2",
        minimum=0.0,
    )
    noise_clearance: float = parameter(
        2.0,
        "least height likewise on its own grid, for surfaces rougher than a voxel",
        unit="standard deviation of the support from its plane",
        minimum=0.0,
    )
