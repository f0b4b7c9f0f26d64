"""What is damaged in a store, and in results, named one by one."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from threedfs.store.files import open_regular, read_regular
from threedfs.store.kernels import ENDING, is_private, read_kernel
from threedfs.store.made import Made
from threedfs.store.objects import Objects
from threedfs.store.records import (
    BadRecord,
    OldRecord,
    adopt_record,
    digests_of,
    is_digest,
    parse_record,
    record_path,
    write_record,
)

_TEMPORARY = ".part"


@dataclass
class Audit:
    """What was looked at, and what was found.

    Attributes
    ----------
    damage : list of str
        A sentence for each damaged file.
    old : list of Path
        Records of the older format, which are not believed.
    objects, records, kernels, results : int
        How many are sound.
    """

    damage: list[str] = field(default_factory=list)
    old: list[Path] = field(default_factory=list)
    objects: int = 0
    records: int = 0
    kernels: int = 0
    results: int = 0


def audit_store(store: Path) -> Audit:
    """Hash all objects, and check all records and kernels of a store; nothing is changed."""
    audit, sound = Audit(), set()
    for path in walk_places(store / "objects"):
        fault = find_fault(path, path.name) if is_digest(path.name) else "is no object"
        if fault is None and path != store / "objects" / path.name[:2] / path.name:
            fault = "lies in the wrong place"
        if fault:
            audit.damage.append(f"{path} {fault}")
        else:
            sound.add(path.name)
            audit.objects += 1
    for path in walk_places(store / "actions"):
        _audit_record(path, store, sound, audit)
    root = store / "kernels"
    kernels = list(walk(root))
    if kernels and not is_private(root):
        audit.damage.append(f"{root} can be written to by others or belongs to another: its kernels are not used")
    for path in kernels:
        if path.suffix in (".nbi", ".nbc"):  # of the older format, which nothing reads any more
            continue
        if path.suffix == ENDING and read_kernel(root, path) is not None:
            audit.kernels += 1
        else:
            audit.damage.append(f"{path} is damaged, or can be written to by others")
    return audit


def audit_results(results: Path, audit: Audit) -> None:
    """Hash all results that are there, and hold them against what their jobs wrote.

    Parameters
    ----------
    results : Path
    audit : Audit
        Gets what is found.
    """
    for path, content in Made(results / ".made").list_all():
        if not os.path.lexists(path):
            continue  # deleted; the next run makes it
        files = {path: content} if isinstance(content, str) else {path / name: one for name, one in content.items()}
        for file, digest in files.items():
            fault = find_fault(file, digest)
            if fault:
                audit.damage.append(f"{file} {fault}")
            else:
                audit.results += 1


def adopt_old(store: Path) -> tuple[int, list[str]]:
    """Give records of the older format a checksum, where all that can be checked holds.

    That is: the key is that of the work, all objects are there and whole, and of the sizes that the record tells.

    Parameters
    ----------
    store : Path

    Returns
    -------
    count : int
        Records that are believed from now on.
    refused : list of str
        A sentence for each other.
    """
    count, refused, objects = 0, [], Objects(store / "objects", None)
    for path in walk_places(store / "actions"):
        try:
            if not _is_old(path):
                continue
            identity, made = adopt_record(read_regular(path), path.stem)
            faults = [find_fault(objects.path(one), one) for one in digests_of(made["outputs"])]
            if any(faults):
                raise BadRecord("names objects that are missing or damaged")
            for name, content in made["outputs"].items():
                if sum(objects.path(one).stat().st_size for one in digests_of({name: content})) != made["bytes"][name]:
                    raise BadRecord("names objects of other sizes")
        except (BadRecord, OSError) as fault:
            refused.append(f"{path} {fault}")
        else:
            write_record(store, path.stem, identity, made)
            count += 1
    return count, refused


def _is_old(path: Path) -> bool:
    try:
        parse_record(read_regular(path), path.stem)
    except OldRecord:
        return True
    except BadRecord:
        pass
    return False


def find_fault(path: Path, digest: str) -> str | None:
    """Say what is wrong with a file that should have a digest; None if nothing is."""
    try:
        with open_regular(path) as file:
            found = hashlib.file_digest(file, "sha256").hexdigest()
    except FileNotFoundError:
        return "is missing"
    except OSError as fault:
        return f"is no file that can be read: {fault.strerror}"
    return None if found == digest else "is damaged"


def walk(folder: Path) -> Iterator[Path]:
    """Yield all that lies below a folder and is no folder, in order.

    Links are not followed, and what jobs are writing at the moment is left out.
    """
    for place, folders, files in os.walk(folder):
        folders.sort()
        links = [name for name in folders if os.path.islink(os.path.join(place, name))]
        for name in sorted([*files, *links]):
            if not name.endswith(_TEMPORARY):
                yield Path(place) / name


def walk_places(folder: Path) -> Iterator[Path]:
    """Yield what lies in the places of objects or records, two levels down, whatever it is; and what lies above."""
    for first in _list(folder):
        if not first.is_dir() or first.is_symlink():
            yield first
            continue
        yield from _list(first)


def _list(folder: Path) -> list[Path]:
    if not folder.is_dir():
        return []
    return sorted(path for path in folder.iterdir() if not path.name.endswith(_TEMPORARY))


def _audit_record(path: Path, store: Path, sound: set[str], audit: Audit) -> None:
    key = path.stem
    try:
        if not is_digest(key) or path != record_path(store, key):
            raise BadRecord("is no record, or lies in the wrong place")
        document = parse_record(read_regular(path), key)
        missing = [digest for digest in digests_of(document["outputs"]) if digest not in sound]
        if missing:
            raise BadRecord(f"names {len(missing)} objects that are missing or damaged, {missing[0]} among them")
    except OldRecord:
        audit.old.append(path)
    except BadRecord as fault:
        audit.damage.append(f"{path} {fault}")
    except OSError as fault:
        audit.damage.append(f"{path} is no file that can be read: {fault.strerror}")
    else:
        audit.records += 1
