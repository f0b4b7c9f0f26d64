"""Keyframes: each entry holds all that its jobs need of cameras, so that it can be keyed by itself."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from threedfs.errors import UserError
from threedfs.io.documents import read_document, write_document
from threedfs.io.schema import KEYFRAMES
from threedfs.io.views import decode_view, encode_view
from threedfs.types import Keyframe, View


def write_keyframes(
    path: Path,
    keyframes: Sequence[Keyframe],
    header: Mapping[str, Any],
    *,
    needs_stereo: bool = False,
    object_pixels: float | None = None,
) -> None:
    """Write keyframes.json; entries are found under ``keyframes.<name>``.

    `needs_stereo` is for the rules: whether depth is to be anchored by stereo matches. `object_pixels` is how long the
    longest side of the object's box is in the views, pixels; None where it is not known.
    """
    entries = {
        keyframe.view.name: {
            "view": encode_view(keyframe.view),
            "neighbours": [encode_view(view) for view in keyframe.neighbours],
            "near": keyframe.near,
            "far": keyframe.far,
            "within": keyframe.within,
            "object_pixels": object_pixels,
        }
        for keyframe in keyframes
    }
    content = {
        "unit": "scene unit",
        "needs_stereo": needs_stereo,
        "order": list(entries),
        "keyframes": entries,
    }
    write_document(path, KEYFRAMES, content, header)


def read_keyframes(path: Path) -> dict[str, Keyframe]:
    """Read all keyframes, by name, in the order of the frames."""
    content = read_document(path, KEYFRAMES)
    return {name: _decode(content["keyframes"][name]) for name in content["order"]}


def read_views(path: Path) -> dict[str, View]:
    """Read the views of all keyframes and of their neighbours, by name."""
    return {view.name: view for entry in read_keyframes(path).values() for view in (entry.view, *entry.neighbours)}


def read_keyframe(path: Path, name: str) -> Keyframe:
    """Read one keyframe.

    Raises
    ------
    UserError
        If the file lists no keyframe of that name.
    """
    entries = read_document(path, KEYFRAMES)["keyframes"]
    if name not in entries:
        raise UserError(f"{path}: expected a keyframe named {name}, got {', '.join(sorted(entries))}.")
    return _decode(entries[name])


def read_object_pixels(path: Path, name: str) -> float | None:
    """Return how long the longest side of the object's box is in a keyframe, pixels, if that is known."""
    return read_document(path, KEYFRAMES)["keyframes"][name].get("object_pixels")


def read_needs_stereo(path: Path) -> bool:
    """Say whether depth is to be anchored by stereo matches."""
    return bool(read_document(path, KEYFRAMES)["needs_stereo"])


def _decode(entry: dict[str, Any]) -> Keyframe:
    return Keyframe(
        view=decode_view(entry["view"]),
        neighbours=tuple(decode_view(view) for view in entry["neighbours"]),
        near=entry["near"],
        far=entry["far"],
        within=tuple(entry["within"]) if entry.get("within") else None,
    )
