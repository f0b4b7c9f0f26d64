"""`threedfs clean`: frees the space of what finished sequences were made by."""

from __future__ import annotations

import argparse
import fcntl
import re
import sys
from collections.abc import Iterator
from pathlib import Path

import yaml

from threedfs.errors import UserError
from threedfs.params.configuration import SEQUENCE_NAME
from threedfs.params.sequences import RUN_FILES

_STAGE = re.compile(r"\d\d_\w+")
_KEPT = {"02_poses", "11_object", "12_evaluate"}
"""Folders of a sequence that hold what a user wants: cameras, meshes and masks, figures."""
_KEPT_SUFFIXES = {".json", ".csv"}
"""Of files that stay wherever they are: small descriptions, figures."""
_MEGABYTE = 1e6


def add_clean(actions: argparse._SubParsersAction) -> None:
    """Add the subcommand."""
    parser = actions.add_parser("clean", help="remove the intermediate files of finished sequences")
    parser.add_argument("sequence", nargs="*", help="name of a sequence, as my or results/my")
    parser.add_argument("--all", action="store_true", help="all finished sequences")
    parser.add_argument("--out", default=".", help="folder that holds results/ (here)")
    parser.add_argument("--yes", action="store_true", help="remove them; without it they are listed only")
    parser.set_defaults(act=clean)


def clean(arguments: argparse.Namespace) -> int:
    """List the intermediate files of finished sequences, and remove them if told to; return the exit status.

    Meshes, masks, figures (CSV), cameras, the report, logs and small descriptions (JSON) stay. A run that needs what
    was removed takes it from the store, or makes it again.

    Raises
    ------
    UserError
        If no sequence was named, one is not there or not finished, or a run is at work.
    """
    # what is numeric takes a second to import: --help need not wait for it
    from threedfs.cli.workflow import claim

    out = Path(arguments.out).expanduser().resolve()
    if bool(arguments.sequence) == arguments.all:
        raise UserError("clean: expected the name of a sequence, as in threedfs clean my, or --all.")
    if not (out / "results").is_dir():
        raise UserError(f"{out}: expected a folder that holds results of runs, found none; use --out.")
    (out / "results/logs").mkdir(exist_ok=True)
    with claim(out):
        _refuse_running(out)
        folders = _find_all(out) if arguments.all else [_find(out, text) for text in arguments.sequence]
        removable = {folder: list(find_intermediate(folder)) for folder in dict.fromkeys(folders)}
        freed = sum(_list(folder, files) for folder, files in removable.items())
        if arguments.yes:
            for folder, files in removable.items():
                _remove(folder, files)
    _tell(out, freed, list(removable), arguments.yes)
    return 0


def find_intermediate(folder: Path) -> Iterator[Path]:
    """Yield the files of a sequence that only its stages need: arrays, and whatever else lies beside them."""
    for stage in sorted(folder.iterdir()):
        if _STAGE.fullmatch(stage.name) and stage.name not in _KEPT and stage.is_dir() and not stage.is_symlink():
            for path in sorted(stage.rglob("*")):
                inside = path.relative_to(stage).parts
                wanted = path.suffix in _KEPT_SUFFIXES or {"logs", "benchmarks"} & set(inside)
                if (path.is_file() or path.is_symlink()) and not wanted:
                    yield path


def _find_all(out: Path) -> list[Path]:
    found = []
    for folder in sorted((out / "results").iterdir()):
        if re.fullmatch(SEQUENCE_NAME, folder.name) and folder.name not in RUN_FILES and folder.is_dir():
            if _is_finished(folder):
                found.append(folder)
            else:
                print(f"threedfs: {folder.name} is not finished, and stays as it is.", file=sys.stderr)
    return found


def _find(out: Path, text: str) -> Path:
    name = Path(text).name
    folder = out / "results" / name
    if not re.fullmatch(SEQUENCE_NAME, name) or name in RUN_FILES or not folder.is_dir():
        raise UserError(f"clean: expected a sequence in {out}/results, found no {text}; correct it, or use --out.")
    if not _is_finished(folder):
        raise UserError(
            f"clean: expected a finished sequence, but {name} is not: run it to its end first, or "
            f"delete {folder} if you do not need it."
        )
    return folder


def _is_finished(folder: Path) -> bool:
    """Say whether a sequence has a mesh or masks and a report that tells of no failure, and no job has failed since."""
    from threedfs.run_end.logs import find_failures
    from threedfs.run_end.summary import read_summary

    made = any((folder / "11_object").glob("*/mesh.ply")) or any((folder / "11_object").glob("*/masks"))
    report, summary = folder / "report.html", read_summary(folder)
    if not made or not report.is_file() or summary is None or summary.failures:
        return False
    since = report.stat().st_mtime
    return all(failure.sequence != folder.name for failure in find_failures(folder.parent, since))


def _refuse_running(out: Path) -> None:
    """Refuse to work beside Snakemake that was started without this command."""
    lock = out / ".snakemake/run.lock"
    if not lock.is_file():
        return
    with open(lock, "a") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise UserError(f"{out}: a run works in this folder; wait for it.") from None


def _list(folder: Path, files: list[Path]) -> float:
    """Print what would be removed of a sequence, by the folder of its stage; return the bytes."""
    sizes: dict[str, int] = {}
    for path in files:
        stage = path.relative_to(folder).parts[0]
        sizes[stage] = sizes.get(stage, 0) + path.lstat().st_size
    for stage, size in sizes.items():
        print(f"{size / _MEGABYTE:9.1f} MB  {folder / stage}")
    return sum(sizes.values())


def _remove(folder: Path, files: list[Path]) -> None:
    for path in files:
        path.unlink()
        for parent in path.parents:
            if parent == folder or any(parent.iterdir()):
                break
            parent.rmdir()


def _tell(out: Path, freed: float, folders: list[Path], done: bool) -> None:
    if not freed:
        print("Nothing to remove.")
    elif done:
        print(f"{freed / _MEGABYTE:9.1f} MB  removed; meshes, masks, reports and figures are as before.")
    else:
        print(f"{freed / _MEGABYTE:9.1f} MB  can be removed; nothing has been removed yet. Add --yes to remove it.")
    for store in dict.fromkeys(_store_of(out, folder) for folder in folders):
        held = sum(path.lstat().st_size for path in store.rglob("*") if path.is_file())
        print(f"{held / _MEGABYTE:9.1f} MB  remain in {store}; later runs take them from there.")


def _store_of(out: Path, folder: Path) -> Path:
    """Return the store that a sequence was last made with by the command; the default one if that is not known."""
    request = folder / "request.yaml"
    config = yaml.safe_load(request.read_text(encoding="utf-8")) if request.is_file() else None
    own = config.get("store") if isinstance(config, dict) else None
    return out / str(own or "results/.store")
