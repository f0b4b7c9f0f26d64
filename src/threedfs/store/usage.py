"""How large a store is, by stage and by sequence, and what of it no result needs."""

from __future__ import annotations

import os
import time
from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from threedfs.store.audit import walk, walk_places
from threedfs.store.files import read_regular
from threedfs.store.heartbeat import is_alive
from threedfs.store.kernels import ENDING
from threedfs.store.records import BadRecord, digests_of, parse_record

KEPT_DAYS = 30.0
"""Kernels, and notes on given files, that were not used for so long are taken to be of what is gone."""
_ABANDONED = 86400.0  # seconds after which work in progress is that of a killed job
_PARTS = ("objects", "actions", "digests", "kernels")


@dataclass(frozen=True)
class Usage:
    """Bytes in a store.

    Attributes
    ----------
    stages, sequences : mapping of str to int
        Of the objects that a stage made, or a sequence needs; what several need is counted for each.
    objects, kernels, rest : int
        Of all objects, each once; of compiled kernels; of records, notes and work in progress.
    """

    stages: Mapping[str, int]
    sequences: Mapping[str, int]
    objects: int
    kernels: int
    rest: int


def measure(store: Path, keys: Mapping[str, Collection[str]]) -> Usage:
    """Measure a store.

    Parameters
    ----------
    store : Path
    keys : mapping of str to collection of str
        The actions that each sequence needs.
    """
    sizes = {path.name: size_of(path) for path in walk_places(store / "objects")}
    by_stage: defaultdict[str, set[str]] = defaultdict(set)
    by_key: dict[str, set[str]] = {}
    for key, record in read_all(store):
        by_key[key] = {*digests_of(record["outputs"])}
        by_stage[record["stage"]] |= by_key[key]
    by_sequence = {name: set().union(*(by_key.get(key, ()) for key in needed)) for name, needed in keys.items()}

    def add(digests: Collection[str]) -> int:
        return sum(sizes.get(digest, 0) for digest in digests)

    kernels = sum(map(size_of, walk(store / "kernels")))
    return Usage(
        {stage: add(digests) for stage, digests in by_stage.items()},
        {name: add(digests) for name, digests in by_sequence.items()},
        sum(sizes.values()),
        kernels,
        sum(map(size_of, walk(store))) - sum(sizes.values()) - kernels,
    )


def find_unneeded(store: Path, keys: Collection[str], now: float | None = None) -> list[Path]:
    """List the files of a store that no action of some needs, nor work that is going on.

    Parameters
    ----------
    store : Path
    keys : collection of str
        Actions to keep.
    now : float or None
        Seconds since the epoch.
    """
    now = time.time() if now is None else now
    kept = {key: digests_of(record["outputs"]) for key, record in read_all(store) if key in keys}
    objects = {digest for digests in kept.values() for digest in digests}
    return [
        *(path for path in walk_places(store / "objects") if path.name not in objects),
        *(path for path in walk_places(store / "actions") if path.stem not in kept),
        *(path for path in walk(store / "kernels") if path.suffix != ENDING or _age(path, now) > KEPT_DAYS * 86400),
        *(path for path in sorted((store / "inputs").glob("*.json")) if _age(path, now) > KEPT_DAYS * 86400),
        *(path for path in sorted((store / "scratch").glob("*")) if _age(path, now) > _ABANDONED),
        *(path for path in sorted((store / "claims").glob("*")) if _age(path, now) > _ABANDONED),
        *(path for part in _PARTS for path in sorted((store / part).rglob("*.part")) if _age(path, now) > _ABANDONED),
    ]


def find_jobs(store: Path) -> list[str]:
    """Return the signs of life of jobs that are at work in a store."""
    return [path.name for path in sorted((store / "claims").glob("*.beat")) if is_alive(path, time.time())]


def read_all(store: Path) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the key and the entries of every record that can be believed."""
    for path in walk_places(store / "actions"):
        try:
            yield path.stem, parse_record(read_regular(path), path.stem)
        except (BadRecord, OSError):
            continue


def size_of(path: Path) -> int:
    """Return the bytes of a file, or of all files of a folder; links are not followed."""
    if path.is_dir() and not path.is_symlink():
        return sum(size_of(one) for one in path.iterdir())
    try:
        return os.lstat(path).st_size
    except OSError:
        return 0


def _age(path: Path, now: float) -> float:
    try:
        status = os.lstat(path)
    except OSError:
        return 0.0
    return now - max(status.st_mtime, status.st_atime)
