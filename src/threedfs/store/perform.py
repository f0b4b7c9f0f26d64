"""Do a stage's work, or take it from the store if the same work was done before."""

from __future__ import annotations

import importlib
import os
import resource
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from threedfs.job import Job
from threedfs.progress import Progress
from threedfs.store.action import Action, Task, identify
from threedfs.store.claims import claim
from threedfs.store.digests import digest_value
from threedfs.store.files import remove, remove_abandoned, temporary_name
from threedfs.store.heartbeat import beating
from threedfs.store.kernels import choose_folder
from threedfs.store.made import Made
from threedfs.store.objects import DamagedObject
from threedfs.store.place import Store, explained
from threedfs.store.records import (
    IDENTITY,
    MADE,
    BadRecord,
    Content,
    digests_of,
    read_record,
    record_path,
    write_record,
)
from threedfs.store.workers import FORKED, ONE_THREAD


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


def perform(
    task: Task,
    store: Path,
    *,
    progress: Progress,
    threads: int = 1,
    fallback: Path | None = None,
    made: Path | None = None,
) -> Outcome:
    """Put a stage's outputs in place, from the store or by running the stage.

    The stage's module (and with it the numeric libraries) is imported only when the store has no such action.

    Parameters
    ----------
    task : Task
    store : Path
    progress : Progress
        Takes the stage's notes.
    threads : int
    fallback, made : Path or None
        As a `Store` has them.

    Raises
    ------
    UserError
        If an input is missing, the stage refuses what it was given, or the store cannot be written to.
    """
    started, place = time.monotonic(), Store(store, fallback, made)
    with explained(store):
        action = identify(task, place.digests(progress))
        found = fetch(action, place, progress)
        if found is not None:
            return found
        with beating(place.claims) as beat:

            def work(action: Action) -> Outcome:
                reason = load_stages({task.module: action.maker}, store, threads)
                if reason:
                    progress.note(reason)
                return make(action, place, Job(progress, action.header, threads, task.seed), started)

            return obtain(action, place, beat, progress, work)


def obtain(action: Action, store: Store, beat: Path, progress: Progress, work: Callable[[Action], Outcome]) -> Outcome:
    """Have an action done that the store was found to lack, unless another job does it meanwhile.

    The stage will read its inputs, so their bytes are looked at first, even if nothing seems to have touched them.

    Parameters
    ----------
    action : Action
    store : Store
    beat : Path
        Sign of life of this job.
    progress : Progress
    work : callable
        Does an action.
    """
    unknown = not record_path(store.folder, action.key).exists()
    sure = identify(action.task, store.digests(progress, thorough=True))
    found = fetch(sure, store, progress) if sure.key != action.key else None
    if found is not None:
        return found
    with claim(store.claims, sure.key, beat, progress.note) as waited:
        done = waited or (unknown and record_path(store.folder, sure.key).exists())  # meanwhile, by another
        found = fetch(sure, store, progress) if done else None
        return work(sure) if found is None else found


def fetch(action: Action, store: Store, progress: Progress) -> Outcome | None:
    """Put the outputs of an action in place if the store, or its fallback, has them; else return None."""
    for folder in filter(None, (store.folder, store.fallback)):
        try:
            record = read_record(folder, action.key)
            if record is None:
                continue
            outputs = record["outputs"]
            if outputs.keys() != action.task.outputs.keys():
                raise BadRecord("names other outputs than the stage has")
            if folder != store.folder:
                _copy_action(record, store)
            _check_out(store, outputs, action.task.outputs)
        except BadRecord as fault:
            progress.note(f"the record of this work {fault}, so the work is done again")
        except DamagedObject as fault:
            progress.note(f"{fault}, so the work is done again")
        else:
            return Outcome(action.key, True)
    return None


def load_stages(makers: Mapping[str, Mapping[str, Any]], store: Path, threads: int) -> str:
    """Import stages by full name, set for a number of threads.

    Kernels that they compile are kept in the store, apart for every state of their code, which `makers` tells. Returns
    why they are kept elsewhere, or an empty text.
    """
    _limit_threads(threads)
    folder, reason = choose_folder(store)
    _keep_kernels(folder / digest_value([makers[module] for module in makers])[:16])
    if FORKED in os.environ:  # numba is imported, and has read its settings before they were made
        importlib.import_module("numba").config.reload_config()
    for module in makers:
        importlib.import_module(module)
    return reason


def make(action: Action, store: Store, job: Job, started: float) -> Outcome:
    """Run a stage that is loaded, keep what it makes in the store and put it in place.

    Parameters
    ----------
    action : Action
    store : Store
    job : Job
        Given to the stage.
    started : float
        When the work on it began, by the monotonic clock.
    """
    objects, outputs = store.objects, action.task.outputs
    _forget_peak_memory()
    with _scratch_folder(store.folder / "scratch", action.key) as folder:
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
    write_record(store.folder, action.key, {**action.source, **action.maker}, made)
    _check_out(store, contents, outputs)
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


def _check_out(store: Store, contents: Mapping[str, Content], outputs: Mapping[str, Path]) -> None:
    for name, path in outputs.items():
        store.objects.check_out(contents[name], path)
        if store.made is not None:
            Made(store.made).remember(path, contents[name])


def _copy_action(record: Mapping[str, Any], store: Store) -> None:
    """Copy what an action made, and its record, from the fallback; where the store cannot be written to, do not."""
    try:
        for digest in digests_of(record["outputs"]):
            if not store.objects.has(digest):
                store.objects.keep_copy(digest)
        identity = {name: record[name] for name in IDENTITY}
        write_record(store.folder, record["key"], identity, {name: record[name] for name in MADE})
    except OSError:  # it is put in place from the fallback itself
        pass


def _limit_threads(threads: int) -> None:
    """Give numba its threads, and the libraries whose sums depend on their number one."""
    os.environ.update(ONE_THREAD)
    os.environ["NUMBA_NUM_THREADS"] = str(threads)


def _keep_kernels(folder: Path) -> None:
    """Have numba keep what it compiles in `folder`, which only one state of the code may use.

    Of a kernel that calls kernels of other files, numba notices edits in its own file only.
    """
    os.environ["NUMBA_CACHE_DIR"] = os.path.abspath(folder)
    os.environ["NUMBA_CACHE_LOCATOR_CLASSES"] = "threedfs.store.kernel_cache.Locator"


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
