"""Parameters of the fuse_object stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter
from threedfs.params.fusion import FusionSettings


@dataclass(frozen=True)
class FuseObjectParams(FusionSettings):
    """How the object is fused on its own grid."""

    thickness_share: float = parameter(
        0.25,
        "largest clip distance as a share of the object's thickness: the field of a thin object must reach -1 inside; "
        "0 for no limit (paper)",
        minimum=0.0,
        maximum=1.0,
    )
