"""What a mesh was painted from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from threedfs.io.documents import read_document, write_document
from threedfs.io.schema import Schema

TEXTURE = Schema("threedfs/texture/1", "texture")


@dataclass(frozen=True)
class TextureRecord:
    """What a mesh was painted from.

    Attributes
    ----------
    painted_from, held_out : list of str
        Names of the photographs.
    charts : int
        Pieces that the texture is made of.
    unseen_share : float
        Of the mesh's area, that no photograph shows.
    """

    painted_from: list[str]
    held_out: list[str]
    charts: int
    unseen_share: float


def write_texture(path: Path, record: TextureRecord, header: Mapping[str, Any]) -> None:
    """Write painted.json."""
    write_document(path, TEXTURE, asdict(record), header)


def read_texture(path: Path) -> TextureRecord:
    """Read what `write_texture` wrote."""
    content = read_document(path, TEXTURE)
    return TextureRecord(**{name: content[name] for name in TextureRecord.__dataclass_fields__})
