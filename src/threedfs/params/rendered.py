"""Sequences whose images the run itself renders, with their truth."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from threedfs.errors import UserError
from threedfs.synthetic.takes import DEPTH_SCALE, take_module

RENDERED_KEYS = {"rendered": {"type": ["string", "null"]}, "true_cameras": {"type": "boolean"}}
"""JSON schema of the keys of a rendered sequence."""

_BROUGHT = ("source", "cameras", "intrinsics", "calibration", "truth")
_TRUTH = {"masks": "masks", "cameras": "cameras.json", "mesh": "mesh.ply", "depth": "depth"}


def find_films(sequences: Mapping[str, Mapping[str, Any]]) -> dict[str, str]:
    """Return for each rendered sequence the one whose film it takes: the first of the same take and render settings."""
    films: dict[str, str] = {}
    first: dict[str, str] = {}
    for name, entry in sequences.items():
        if entry.get("rendered") is not None:
            wanted = json.dumps([entry["rendered"], (entry.get("settings") or {}).get("render")], sort_keys=True)
            films[name] = first.setdefault(wanted, name)
    return films


def bring_render(name: str, entry: Mapping[str, Any], film: str) -> Mapping[str, Any]:
    """Return a sequence's entry of the configuration, that of a rendered one with the results of the stage `render`.

    Parameters
    ----------
    name : str
        Of the sequence.
    entry : mapping
    film : str
        Name of the sequence whose film it takes, its own or another's.

    Raises
    ------
    UserError
        If it is not clear where the images come from, or there is no such take.
    """
    where, take = f"configuration, sequences.{name}", entry.get("rendered")
    if take is None:
        if entry.get("source") is None:
            raise UserError(
                f"{where}: expected the key source (a video or photos) or rendered (a take), found neither; "
                "see config/README.md."
            )
        if entry.get("true_cameras"):
            raise UserError(f"{where}.true_cameras: only a rendered sequence has them; give its cameras instead.")
        return entry
    beside = [key for key in _BROUGHT if entry.get(key) is not None]
    if beside:
        raise UserError(
            f"{where}: expected no {', '.join(beside)} beside rendered; a rendered sequence brings its own images, "
            "cameras and truth."
        )
    try:
        take_module(take)
    except UserError as fault:
        raise UserError(f"{where}.{fault}") from fault
    folder = f"results/{film}/00_render"
    return {
        **entry,
        "source": f"{folder}/video.mp4",
        "cameras": f"{folder}/cameras.json" if entry.get("true_cameras") else None,
        "truth": {key: f"{folder}/{file}" for key, file in _TRUTH.items()} | {"depth_scale": DEPTH_SCALE},
    }
