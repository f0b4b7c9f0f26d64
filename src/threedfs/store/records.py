"""Action records: what was made of what, believed only where every byte of it can be checked."""

from __future__ import annotations

import json
import math
import os
import re
from collections.abc import Mapping
from pathlib import Path, PurePosixPath
from typing import Any

from threedfs.store.digests import digest_value
from threedfs.store.files import make_folder, read_regular, remove, write_atomically

FORMAT = "threedfs/action/2"
IDENTITY = ("stage", "parameters", "seed", "wildcards", "inputs", "code", "versions")
"""Entries whose digest is the key of the action."""
MADE = ("outputs", "bytes", "seconds", "peak_memory_mb")
"""Entries of what it came to, and what that cost."""

Content = str | dict[str, str]
"""What an output holds: the digest of a file, or digests by relative name of the files of a folder."""

_LONGEST_NAME = 255  # bytes of a part of a path, on every common file system
_LONGEST_PATH = 1024
_DIGEST = re.compile(r"[0-9a-f]{64}")


class BadRecord(Exception):
    """A record that cannot be believed; the message says why, without a subject."""


class OldRecord(BadRecord):
    """A record of before records had checksums."""


def is_digest(text: Any) -> bool:
    """Say whether a value is a SHA-256 in 64 small hexadecimal digits."""
    return isinstance(text, str) and _DIGEST.fullmatch(text) is not None


def is_plain_name(name: Any) -> bool:
    """Say whether a value names a file inside a folder: relative, without `.`, `..` or what no file system takes."""
    if not isinstance(name, str) or "\0" in name or name.startswith("/"):
        return False
    try:
        parts = [os.fsencode(part) for part in name.split("/")]
    except UnicodeEncodeError:  # half a surrogate pair
        return False
    short = all(len(part) <= _LONGEST_NAME for part in parts) and sum(map(len, parts)) <= _LONGEST_PATH
    return short and not {b"", b".", b".."} & {*parts}


def record_path(store: Path, key: str) -> Path:
    """Return where the record of an action lies."""
    return store / "actions" / key[:2] / f"{key}.json"


def read_record(store: Path, key: str) -> dict[str, Any] | None:
    """Read the record of an action; None if there is none.

    Raises
    ------
    BadRecord
        If there is one that cannot be believed.
    """
    try:
        data = read_regular(record_path(store, key))
    except FileNotFoundError:
        return None
    except OSError as fault:
        raise BadRecord(f"cannot be read: {fault.strerror}") from None
    return parse_record(data, key)


def write_record(store: Path, key: str, identity: Mapping[str, Any], made: Mapping[str, Any]) -> None:
    """Write the record of an action, sealed with its checksum.

    Parameters
    ----------
    store : Path
    key : str
    identity : mapping
        The entries `IDENTITY`.
    made : mapping
        ``outputs`` (`Content` by name), ``bytes`` (by name), ``seconds``, ``peak_memory_mb``.
    """
    document = {"format": FORMAT, "key": key, **identity, **made}
    path = record_path(store, key)
    make_folder(path.parent)
    if path.is_symlink() or not path.is_file():
        remove(path)
    write_atomically(path, _render({**document, "checksum": digest_value(document)}))


def parse_record(data: bytes, key: str) -> dict[str, Any]:
    """Check a record and return its entries.

    Every byte counts: the record is written anew from what was read of it, and must come out the same; its checksum
    must be that of its entries, and its key the one asked for and the digest of what identifies the action.

    Raises
    ------
    BadRecord
        If anything of this does not hold, or it names what no action can have made.
    """
    document = _load(data)
    if isinstance(document, dict) and "format" not in document and {*IDENTITY, *MADE} == {*document}:
        raise OldRecord("is of an older format, without a checksum (`threedfs store adopt` keeps what can be checked)")
    try:
        if {*document} != {"format", "key", "checksum", *IDENTITY, *MADE} or document["format"] != FORMAT:
            raise BadRecord("is damaged: it has not the entries of a record")
        checksum = digest_value({name: value for name, value in document.items() if name != "checksum"})
        if checksum != document["checksum"] or _render(document) != data:
            raise BadRecord("is damaged: its checksum is not that of its content")
    except (TypeError, ValueError, RecursionError):
        raise BadRecord("is damaged: it is no record") from None
    _check_entries(document, key)
    return document


def adopt_record(data: bytes, key: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """Check what can be checked of a record of the older format; return what identifies the action, and what it made.

    Raises
    ------
    BadRecord
        If it is damaged, or of another format.
    """
    document = _load(data)
    if not isinstance(document, dict) or {*document} != {*IDENTITY, *MADE}:
        raise BadRecord("is damaged: it has not the entries of a record")
    _check_entries({**document, "key": key}, key)
    return {name: document[name] for name in IDENTITY}, {name: document[name] for name in MADE}


def digests_of(outputs: Mapping[str, Content]) -> list[str]:
    """Return the digests of all files of an action's outputs."""
    contents = ([content] if isinstance(content, str) else content.values() for content in outputs.values())
    return [digest for digests in contents for digest in digests]


def _load(data: bytes) -> Any:
    try:
        return json.loads(data)
    except (ValueError, RecursionError):
        raise BadRecord("is damaged: it is no JSON") from None


def _render(document: Mapping[str, Any]) -> bytes:
    return json.dumps(document, sort_keys=True, indent=1, allow_nan=False).encode() + b"\n"


def _check_entries(document: Mapping[str, Any], key: str) -> None:
    try:
        own = digest_value({name: document[name] for name in IDENTITY})
    except (TypeError, ValueError, RecursionError):
        raise BadRecord("is damaged: it is no record") from None
    if document["key"] != key or own != key:
        raise BadRecord("is that of other work")
    outputs, sizes = document["outputs"], document["bytes"]
    if not isinstance(outputs, dict) or not isinstance(sizes, dict) or outputs.keys() != sizes.keys():
        raise BadRecord("is impossible: it names no outputs")
    if not all(_is_count(size) for size in sizes.values()):
        raise BadRecord("is impossible: an output has no size")
    if not (_is_number(document["seconds"]) and _is_number(document["peak_memory_mb"])):
        raise BadRecord("is impossible: it took no time or memory")
    for content in outputs.values():
        _check_content(content)


def _check_content(content: Any) -> None:
    digests = content.values() if isinstance(content, dict) else [content]
    if not all(is_digest(digest) for digest in digests):
        raise BadRecord("is impossible: it names an object that is no SHA-256")
    if isinstance(content, dict):
        if not all(is_plain_name(name) for name in content):
            raise BadRecord("is impossible: it names a file that does not lie in the output's folder")
        folders = {parent.as_posix() for name in content for parent in PurePosixPath(name).parents}
        if folders & content.keys():
            raise BadRecord("is impossible: a file is a folder as well")


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value) and value >= 0


def _is_count(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and value >= 0
