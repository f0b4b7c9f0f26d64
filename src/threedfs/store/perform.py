"""Do a stage's work, or take it from the store if the same work was done before."""

from __future__ import annotations

import importlib
import json
import os
import resource
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from threedfs.job import Job
from threedfs.progress import Progress
from threedfs.store.action import Action, Task, identify
from threedfs.store.digests import InputDigests, digest_value
from threedfs.store.files import remove, remove_abandoned, temporary_name, write_atomically
from threedfs.store.objects import Content, DamagedObject, Objects


@dataclass(frozen=True)
class Outcome:
    """How a task went.

    Attributes
    ----------
    key : str
        Names the action.
    hit : bool
        Whether the store had it.
    """

    key: str
    hit: bool


def perform(task: Task, store: Path, *, progress: Progress, threads: int = 1) -> Outcome:
    """Put a stage's outputs in place, from the store or by running the stage.

    The stage's module (and with it the numeric libraries) is imported only when the store has no such action.

    Parameters
    ----------
    task : Task
    store : Path
    progress : Progress
        Takes the stage's notes.
    threads : int

    Raises
    ------
    UserError
        If an input is missing, or the stage refuses what it was given.
    """
    started = time.monotonic()
    action = identify(task, InputDigests(store / "digests"))
    found = fetch(action, store, progress)
    if found is None:
        load_stages({task.module: action.maker}, store, threads)
        found = make(action, store, Job(progress, action.header, threads, task.seed), started)
    return found


def fetch(action: Action, store: Path, progress: Progress) -> Outcome | None:
    """Put the outputs of an action in place if the store has them; else return None."""
    known = _read_outputs(_record(store, action.key))
    if known is None or known.keys() != action.task.outputs.keys():
        return None
    try:
        _check_out(_objects(store), known, action.task.outputs)
    except DamagedObject as fault:
        progress.note(f"{fault}, so the work is done again")
        return None
    return Outcome(action.key, True)


def load_stages(makers: Mapping[str, Mapping[str, Any]], store: Path, threads: int) -> None:
    """Import stages by full name, set for a number of threads.

    Kernels that they compile are kept in the store, apart for every state of their code, which `makers` tells.
    """
    _limit_threads(threads)
    _keep_kernels(store / "kernels" / digest_value([makers[module] for module in makers])[:16])
    for module in makers:
        importlib.import_module(module)


def make(action: Action, store: Path, job: Job, started: float) -> Outcome:
    """Run a stage that is loaded, keep what it makes in the store and put it in place.

    Parameters
    ----------
    action : Action
    store : Path
    job : Job
        Given to the stage.
    started : float
        When the work on it began, by the monotonic clock.
    """
    objects, outputs = _objects(store), action.task.outputs
    _forget_peak_memory()
    with _scratch_folder(store / "scratch", action.key) as folder:
        built = {name: folder / name / path.name for name, path in outputs.items()}
        _run_stage(action, built, job)
        sizes = {name: _size(path) for name, path in built.items()}
        contents = {name: objects.take_in(path) for name, path in built.items()}
    made = {
        "outputs": contents,
        "bytes": sizes,
        "seconds": round(time.monotonic() - started, 3),
        "peak_memory_mb": _peak_memory_mb(),
    }
    # last, so that what it names is there
    text = json.dumps({**action.source, **action.maker, **made}, sort_keys=True, indent=1)
    write_atomically(_record(store, action.key), text.encode() + b"\n")
    _check_out(objects, contents, outputs)
    return Outcome(action.key, False)


def _run_stage(action: Action, outputs: Mapping[str, Path], job: Job) -> None:
    for path in outputs.values():
        path.parent.mkdir(parents=True)
    task = action.task
    run = importlib.import_module(task.module).run
    given = {} if action.params is None else {"params": action.params}
    run(**task.inputs, **outputs, **task.wildcards, **given, job=job)
    missing = [name for name, path in outputs.items() if not path.exists()]
    if missing:
        raise RuntimeError(f"{task.module} did not write its output {', '.join(missing)}")


def _record(store: Path, key: str) -> Path:
    return store / "actions" / key[:2] / f"{key}.json"


def _objects(store: Path) -> Objects:
    return Objects(store / "objects", InputDigests(store / "digests"))


@contextmanager
def _scratch_folder(scratch: Path, key: str) -> Iterator[Path]:
    """Give a folder to work in, on the store's file system; clear away those of killed jobs."""
    scratch.mkdir(parents=True, exist_ok=True)
    remove_abandoned(scratch)
    folder = temporary_name(scratch / key)
    remove(folder)
    try:
        yield folder
    finally:
        remove(folder)


def _check_out(objects: Objects, contents: Mapping[str, Content], outputs: Mapping[str, Path]) -> None:
    for name, path in outputs.items():
        objects.check_out(contents[name], path)


def _read_outputs(record: Path) -> dict[str, Content] | None:
    """Return what an action made, or None if it is not known or its record is damaged."""
    try:
        outputs = json.loads(record.read_text())["outputs"]
    except (OSError, ValueError, KeyError, TypeError):
        return None
    return outputs if isinstance(outputs, dict) else None


def _limit_threads(threads: int) -> None:
    """Give numba its threads, and the libraries whose sums depend on their number one."""
    for variable in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"):
        os.environ[variable] = "1"
    os.environ["NUMBA_NUM_THREADS"] = str(threads)


def _keep_kernels(folder: Path) -> None:
    """Have numba keep what it compiles in `folder`, which only one state of the code may use.

    Of a kernel that calls kernels of other files, numba notices edits in its own file only.
    """
    os.environ["NUMBA_CACHE_DIR"] = os.path.abspath(folder)


def _size(path: Path) -> int:
    files = path.rglob("*") if path.is_dir() else [path]
    return sum(file.stat().st_size for file in files if file.is_file())


def _forget_peak_memory() -> None:
    """Have the peak of this process start anew, so that what it did before does not count; where Linux lets it."""
    try:
        Path("/proc/self/clear_refs").write_text("5")
    except OSError:
        pass


def _peak_memory_mb() -> int:
    """Return the most memory that this process or one of its children held, in MB."""
    peaks = (resource.getrusage(who).ru_maxrss for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return round(max(peaks) / 1024)
