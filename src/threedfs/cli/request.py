"""What a user asks for, checked and turned into a configuration of the workflow."""

from __future__ import annotations

import os
import re
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from threedfs.errors import UserError
from threedfs.params.configuration import LONGEST_NAME
from threedfs.params.sequences import RUN_FILES
from threedfs.params.sizes import read_board, read_length

INTERRUPTED = 130
"""Exit status after Ctrl-C, as of a shell."""
QUALITIES = ("draft", "normal", "fine")
_OWN = ("sequences", "video")


@dataclass(frozen=True)
class Request:
    """One video, or folder of photos, to reconstruct.

    Attributes
    ----------
    source : Path
    name : str
        Of its folder of results.
    scale : mapping or None
        What tells its size, as the configuration has it: `{"tag": "40mm"}`.
    """

    source: Path
    name: str
    scale: Mapping[str, Any] | None = None


def read_height(text: str) -> float:
    """Return a height in millimetres, as in 95mm, 9.5cm, 0.095m, 3.7in; a bare number is millimetres.

    Raises
    ------
    UserError
        If it is no positive length.

    Examples
    --------
    >>> read_height("9.5cm"), read_height("95")
    (95.0, 95.0)
    """
    return read_length(text, "--height")


def read_scale(tag: str | None, board: str | None, height: str | None) -> dict[str, Any] | None:
    """Return what the flags of `threedfs run` say of the size, as the configuration has it; None without any.

    Raises
    ------
    UserError
        If one is not of its form.

    Examples
    --------
    >>> read_scale(None, "9x6:25mm", None)
    {'board': {'corners': [9, 6], 'square': '25mm'}}
    """
    if tag is not None:
        read_length(tag, "--tag")
        return {"tag": tag}
    if board is not None:
        return {"board": read_board(board)}
    if height is not None:
        read_height(height)
        return {"height": height}
    return None


def name_sequence(source: Path) -> str:
    """Return a name for the results of a file, of letters, digits, dots, dashes and underscores.

    A name with none of these becomes a digest of it, and a very long one ends in a digest, so that two such files are
    told apart.

    Examples
    --------
    >>> name_sequence(Path("My Video (1).mov"))
    'My_Video_1'
    """
    stem = stem_of(source)
    name = re.sub(r"[^A-Za-z0-9.\-]+", "_", stem).strip("_.-")
    digest = f"{zlib.crc32(stem.encode(errors='surrogateescape')):08x}"
    if not name:
        return f"video_{digest}"
    if len(name) > LONGEST_NAME:
        return f"{name[: LONGEST_NAME - len(digest) - 1]}_{digest}"
    return f"{name}_video" if name in RUN_FILES else name


def stem_of(source: Path) -> str:
    """Return a file's name without its ending, or a folder's whole name."""
    return source.name if source.is_dir() else source.stem


def count_cores() -> int:
    """Return how many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def list_requests(sources: Sequence[str], scale: Mapping[str, Any] | None = None) -> list[Request]:
    """Return what is to be reconstructed, each under a name of its own; what tells the size is the same of all.

    Raises
    ------
    UserError
        If a file is not there, or two would have the same name.
    """
    requests: dict[str, Request] = {}
    for text in sources:
        source = Path(text).expanduser()
        if not source.exists():
            raise UserError(f"{text}: expected a video or a folder of photos, found nothing there.")
        name = name_sequence(source.resolve())
        if name in requests:
            raise UserError(
                f"{text}: expected a name of its own, but its results would be called {name}, like those of "
                f"{requests[name].source}; rename one."
            )
        requests[name] = Request(source.resolve(), name, scale)
    return list(requests.values())


def read_settings(changes: Sequence[str]) -> dict[str, Any]:
    """Return the configuration that changes such as `depth.iterations=5` or `seed=2` make; the workflow checks it.

    Raises
    ------
    UserError
        If a change is not of this form.

    Examples
    --------
    >>> read_settings(["depth.iterations=5", "seed=2"])
    {'depth': {'iterations': 5}, 'seed': 2}
    """
    config: dict[str, Any] = {}
    for change in changes:
        key, equals, text = change.partition("=")
        parts = key.strip().split(".")
        if parts[0] in _OWN:
            raise UserError(f"--set: expected a parameter, got {parts[0]}; videos are given without --set.")
        if not equals or not all(parts) or len(parts) > 2:
            raise UserError(f"--set: expected STAGE.PARAMETER=VALUE, as in depth.iterations=5, got {change!r}.")
        try:
            value = yaml.safe_load(text)
        except (yaml.YAMLError, ValueError, RecursionError):  # such as a date that there is not
            raise UserError(f"--set: expected a value after {key}=, got {text!r}; see config/README.md.") from None
        if len(parts) == 1:
            config[parts[0]] = value
        elif isinstance(section := config.setdefault(parts[0], {}), dict):
            section[parts[1]] = value
        else:
            raise UserError(f"--set: {parts[0]} was given one value before, and now a parameter {parts[1]} of it.")
    return config


def make_configuration(requests: Sequence[Request], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the workflow is given."""
    sequences = {
        request.name: {"source": str(request.source)} | ({"scale": dict(request.scale)} if request.scale else {})
        for request in requests
    }
    return {"dataset": "mine", **changes, "sequences": sequences}
