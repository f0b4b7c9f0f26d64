"""How large a unit of the scene is, and how that was found."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from threedfs.io.documents import read_document, write_document
from threedfs.io.schema import Schema

SCALE = Schema("threedfs/scale/1", "scale")


@dataclass(frozen=True)
class Scale:
    """Metric scale of a sequence.

    Attributes
    ----------
    metres_per_unit : float
        Metres in a scene unit.
    uncertainty : float or None
        About one standard deviation, as a share of it; None for a given height.
    source : str
        tag, board or height.
    known : float
        The length that was given, metres: side of the tag, side of a square of the board, or height of the object.
    frames : int
        That see tag or board; 0 for a given height.
    detail : str
        The tags, the board's corners, or the method whose mesh has that height.
    """

    metres_per_unit: float
    uncertainty: float | None
    source: str
    known: float
    frames: int
    detail: str


def write_scale(path: Path, scale: Scale, header: Mapping[str, Any]) -> None:
    """Write scale.json."""
    write_document(path, SCALE, {"unit": "metres in a scene unit", **asdict(scale)}, header)


def read_scale(path: Path) -> Scale:
    """Read scale.json."""
    content = read_document(path, SCALE)
    return Scale(**{name: content[name] for name in Scale.__dataclass_fields__})


def find_scale(sequence: Path) -> Scale | None:
    """Return the scale in the results of a sequence, None where none was asked for."""
    path = sequence / "11_object/scale.json"
    return read_scale(path) if path.is_file() else None


def tell_scale(scale: Scale) -> str:
    """Say in a few words how the size was found.

    Examples
    --------
    >>> tell_scale(Scale(0.25, 0.004, "tag", 0.04, 31, "april_36h11 0"))
    'tag of 40 mm (april_36h11 0) in 31 frames, uncertain by 0.4 %'
    >>> tell_scale(Scale(0.25, None, "height", 0.095, 0, "surface"))
    'given height of 95 mm'
    """
    length = f"{1000 * scale.known:g} mm"
    if scale.uncertainty is None:  # nothing was measured
        return f"given height of {length}"
    what = {"tag": f"tag of {length}", "board": f"board with squares of {length}"}[scale.source]
    return f"{what} ({scale.detail}) in {scale.frames} frames, uncertain by {100 * scale.uncertainty:.1f} %"
