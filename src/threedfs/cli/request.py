"""What a user asks for, checked and turned into a configuration of the workflow."""

from __future__ import annotations

import math
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

INTERRUPTED = 130
"""Exit status after Ctrl-C, as of a shell."""
QUALITIES = ("draft", "normal", "fine")
_OWN = ("sequences", "video")
_MILLIMETRES = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4, "": 1.0}


@dataclass(frozen=True)
class Request:
    """One video, or folder of photos, to reconstruct.

    Attributes
    ----------
    source : Path
    name : str
        Of its folder of results.
    """

    source: Path
    name: str


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
    match = re.fullmatch(r"\s*([0-9]*\.?[0-9]+(?:[eE][-+]?\d+)?)\s*(mm|cm|m|in|)\s*", text)
    height = float(match[1]) * _MILLIMETRES[match[2]] if match else 0.0
    if not 0 < height < math.inf:
        raise UserError(f"--height: expected a length such as 95mm, 9.5cm or 0.095m, got {text!r}.")
    return height


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


def list_requests(sources: Sequence[str]) -> list[Request]:
    """Return what is to be reconstructed, each under a name of its own.

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
        requests[name] = Request(source.resolve(), name)
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
    sequences = {request.name: {"source": str(request.source)} for request in requests}
    return {"dataset": "mine", **changes, "sequences": sequences}
