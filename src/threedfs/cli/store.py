"""`threedfs store`: what is in the store of finished work, what is damaged, what can go."""

from __future__ import annotations

from argparse import Namespace, _SubParsersAction
from pathlib import Path

from threedfs.errors import UserError

_UNITS = ("B", "kB", "MB", "GB", "TB")


def add_parser(actions: _SubParsersAction) -> None:
    """Add the command and its own commands."""
    store = actions.add_parser("store", help="size, damage and clearing of the store of finished work")
    parts = store.add_subparsers(required=True, metavar="WHAT")
    for name, act, meaning in (
        ("du", _measure, "sizes by sequence and stage"),
        ("verify", _verify, "check all objects, records and kernels, and name all damage"),
        ("gc", _clear, "list what no result needs; with --delete, remove it"),
        ("adopt", _adopt, "keep records of an older version, which have no checksum, where they can be checked"),
    ):
        part = parts.add_parser(name, help=meaning)
        part.add_argument(
            "--out", type=Path, action="append", help="folder that holds results/; can be repeated (here)"
        )
        part.add_argument("--store", type=Path, help="the store (results/.store of the first of these folders)")
        part.set_defaults(act=act)
        if name == "verify":
            part.add_argument("--results", action="store_true", help="check results against what their jobs wrote, too")
        if name == "gc":
            part.add_argument("--delete", action="store_true", help="remove it")


def _measure(arguments: Namespace) -> int:
    from threedfs.store.usage import measure

    store = _find_store(arguments)
    usage = measure(store, _find_keys(arguments))
    for title, sizes in (("stage", usage.stages), ("sequence", usage.sequences)):
        for name, size in sorted(sizes.items(), key=lambda item: (-item[1], item[0])):
            print(f"{title:10}{name:28}{_tell(size):>10}")
    for name in ("objects", "kernels", "rest"):
        print(f"{name:38}{_tell(getattr(usage, name)):>10}")
    print(f"{'all':38}{_tell(usage.objects + usage.kernels + usage.rest):>10}  {store}")
    return 0


def _verify(arguments: Namespace) -> int:
    from threedfs.store.audit import audit_results, audit_store

    store = _find_store(arguments)
    audit = audit_store(store)
    if arguments.results:
        for results in _find_results(arguments):
            audit_results(results, audit)
    for sentence in audit.damage:
        print(sentence)
    if audit.old:
        print(f"{len(audit.old)} records are of an older format and are not used (`threedfs store adopt` checks them)")
    counts = f"{audit.objects} objects, {audit.records} records, {audit.kernels} kernels"
    if arguments.results:
        counts += f", {audit.results} files of results"
    print(f"sound: {counts}; damaged: {len(audit.damage)}")
    if audit.damage:
        raise UserError(
            f"{store}: found {len(audit.damage)} damaged files, named above; a run makes those of the store anew when "
            "it needs them, and takes damaged results from the store again when a job reads them."
        )
    return 0


def _clear(arguments: Namespace) -> int:
    from threedfs.store.files import remove
    from threedfs.store.usage import find_jobs, find_unneeded, size_of

    store, results = _find_store(arguments), _find_results(arguments)
    keys = {key for needed in _find_keys(arguments).values() for key in needed}
    if arguments.delete and (jobs := find_jobs(store)):
        raise UserError(f"{store}: expected no job at work, found {', '.join(jobs)}; wait for it, and try again.")
    found = find_unneeded(store, keys)
    total = sum(map(size_of, found))
    if arguments.delete:
        for path in found:
            remove(path)
    else:
        for path in found:
            print(path.relative_to(store))
    done = "removed" if arguments.delete else "can go (--delete removes them)"
    kept = ", ".join(map(str, results))
    print(f"{len(found)} files, {_tell(total)}, {done}; kept: what {kept} needs, {len(keys)} actions")
    return 0


def _adopt(arguments: Namespace) -> int:
    from threedfs.store.audit import adopt_old

    store = _find_store(arguments)
    count, refused = adopt_old(store)
    for sentence in refused:
        print(sentence)
    print(f"{count} records are used again, {len(refused)} are not")
    return 0


def _find_store(arguments: Namespace) -> Path:
    store = arguments.store or _find_outs(arguments)[0] / "results" / ".store"
    if not any((store / name).is_dir() for name in ("objects", "actions", "kernels", "digests")):
        raise UserError(f"--store: expected a store of finished work, found none at {store}; name its folder.")
    return store


def _find_outs(arguments: Namespace) -> list[Path]:
    return arguments.out or [Path()]


def _find_results(arguments: Namespace) -> list[Path]:
    folders = [out / "results" for out in _find_outs(arguments)]
    for folder in folders:
        if not folder.is_dir():
            raise UserError(f"--out: expected a folder that holds results/, found none in {folder.parent}.")
    return folders


def _find_keys(arguments: Namespace) -> dict[str, set[str]]:
    """Return the actions of every sequence of the results, by name."""
    from threedfs.run_end.logs import read_keys

    several = len(_find_outs(arguments)) > 1
    keys = {}
    for results in _find_results(arguments):
        for folder in sorted(path for path in results.iterdir() if path.is_dir() and not path.name.startswith(".")):
            found = read_keys(folder)
            if found:
                shown = folder.with_name("(tables of all)") if folder.name == "logs" else folder
                keys[str(shown) if several else shown.name] = found
    return keys


def _tell(size: float) -> str:
    for unit in _UNITS:
        if size < 1000 or unit == _UNITS[-1]:
            return f"{size:.0f} {unit}" if unit == "B" else f"{size:.1f} {unit}"
        size /= 1000
    raise AssertionError
