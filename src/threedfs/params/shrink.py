"""Parameters of the shrink stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter


@dataclass(frozen=True)
class ShrinkParams:
    """How large the frames are in which the object is looked for."""

    longest_side: int = parameter(320, "longer side of the frames of the scene pass", unit="pixel", minimum=64)
