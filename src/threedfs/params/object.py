"""Parameters of the object stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.component import ComponentSettings
from threedfs.params.field import parameter


@dataclass(frozen=True)
class ObjectParams(ComponentSettings):
    """How the object is told from the rest of its grid."""

    clearance: float = parameter(
        1.0,
        "least height above the plane from which voxels may belong to the object",
        unit="voxel",
        symbol="tau",
        equation="Sec. 3.4.2",
        minimum=0.0,
    )
    noise_clearance: float = parameter(
        2.0,
        "least height likewise, for surfaces rougher than a voxel",
        unit="standard deviation of the support from its plane",
        minimum=0.0,
    )
