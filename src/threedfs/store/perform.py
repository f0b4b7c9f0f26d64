"""Do a stage's work, or take it from the store if the same work was done before."""

from __future__ import annotations

import importlib
import json
import os
import platform
import resource
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from threedfs.job import Job
from threedfs.params.schema import find_params, make_params
from threedfs.progress import Progress
from threedfs.store.code import digest_code, library_versions
from threedfs.store.digests import InputDigests, digest_value
from threedfs.store.files import remove, remove_abandoned, temporary_name, write_atomically
from threedfs.store.objects import Content, DamagedObject, Objects

Inputs = Mapping[str, Path | list[Path] | None]


@dataclass(frozen=True)
class Outcome:
    """How a job went.

    Attributes
    ----------
    key : str
        Names the action.
    hit : bool
        Whether the store had it.
    seconds : float
        Of this job, taking from the store included.
    """

    key: str
    hit: bool
    seconds: float


@dataclass(frozen=True)
class Action:
    """What a job is about to do, identified before any of it is done.

    Attributes
    ----------
    stage : str
        Full name of the stage's module.
    source : mapping
        What its outputs are made from: stage, parameters, seed, wildcards and digests of the inputs.
    maker : mapping
        What makes them: the digest of the code and the versions of the libraries that it imports.
    params : object or None
        The stage's parameters.
    """

    stage: str
    source: Mapping[str, Any]
    maker: Mapping[str, Any]
    params: Any

    @property
    def key(self) -> str:
        """The name of the action in the store."""
        return digest_value({**self.source, **self.maker})

    @property
    def header(self) -> dict[str, Any]:
        """What goes into every artifact; without the code, so that an edit that changes no result changes no byte."""
        return {"parameters": self.source["parameters"], "provenance": digest_value(self.source)}


def perform(
    stage: str,
    inputs: Inputs,
    outputs: Mapping[str, Path],
    settings: Mapping[str, Any],
    wildcards: Mapping[str, Any],
    store: Path,
    *,
    progress: Progress,
    threads: int = 1,
    seed: int = 0,
    modules: Sequence[str] = (),
    package: str = "threedfs",
) -> Outcome:
    """Put a stage's outputs in place, from the store or by running the stage.

    The key of an action is the digest of: stage, code, parameters, seed, wildcards, content of the inputs, versions of
    the libraries that the code imports. Threads, paths and the name of the sequence do not enter it. The stage's module
    (and with it the numeric libraries) is imported only when the store has no such action. Kernels that it compiles are
    kept in the store, apart for every state of the code.

    Parameters
    ----------
    stage : str
        Name of a module of ``<package>.stages`` with a ``run``.
    inputs : mapping of str to Path, list of Path, or None
        A path may be a file or a folder; None is an optional input that is absent.
    outputs : mapping of str to Path
        Files, or folders if the stage makes folders.
    settings : mapping
        Every parameter of the stage.
    wildcards : mapping of str to JSON values
        What tells this job from others of its stage; given to the stage too.
    store : Path
    progress : Progress
        Takes the stage's notes.
    threads : int
    seed : int
    modules : sequence of str
        Full names of the modules that the stage loads by name; they count as its code.
    package : str
        Where stages are looked up.

    Raises
    ------
    UserError
        If an input is missing, or the stage refuses what it was given.
    """
    started = time.monotonic()
    digests = InputDigests(store / "digests")
    objects = Objects(store / "objects", digests)
    action = _identify(stage, inputs, settings, wildcards, digests, seed, modules, package)
    record = store / "actions" / action.key[:2] / f"{action.key}.json"
    known = _read_outputs(record)
    if known is not None and known.keys() == outputs.keys():
        try:
            _check_out(objects, known, outputs)
            return Outcome(action.key, True, time.monotonic() - started)
        except DamagedObject as fault:
            progress.note(f"{fault}, so the work is done again")
    job = Job(progress=progress, header=action.header, threads=threads, seed=seed)
    with _scratch_folder(store / "scratch", action.key) as folder:
        built = {name: folder / name / path.name for name, path in outputs.items()}
        _run_stage(action, inputs, built, wildcards, store / "kernels", job)
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
    write_atomically(record, text.encode() + b"\n")
    _check_out(objects, contents, outputs)
    return Outcome(action.key, False, time.monotonic() - started)


def _identify(
    stage: str,
    inputs: Inputs,
    settings: Mapping[str, Any],
    wildcards: Mapping[str, Any],
    digests: InputDigests,
    seed: int,
    modules: Sequence[str],
    package: str,
) -> Action:
    module = f"{package}.stages.{stage}"
    code = digest_code(module, *modules)
    declared = find_params(stage, package)
    params = None if declared is None else make_params(declared, settings)
    source = {
        "stage": stage,
        "parameters": _plain(params),
        "seed": seed,
        "wildcards": dict(wildcards),
        "inputs": digests.inputs(inputs, wildcards.get("keyframe")),
    }
    python = ".".join(platform.python_version_tuple()[:2])
    maker = {"code": code.digest, "versions": {"python": python, **library_versions(code.libraries)}}
    return Action(module, source, maker, params)


def _run_stage(
    action: Action,
    inputs: Inputs,
    outputs: Mapping[str, Path],
    wildcards: Mapping[str, Any],
    kernels: Path,
    job: Job,
) -> None:
    for path in outputs.values():
        path.parent.mkdir(parents=True)
    _limit_threads(job.threads)
    _keep_kernels(kernels / digest_value(action.maker)[:16])
    run = importlib.import_module(action.stage).run
    given = {} if action.params is None else {"params": action.params}
    run(**inputs, **outputs, **wildcards, **given, job=job)
    missing = [name for name, path in outputs.items() if not path.exists()]
    if missing:
        raise RuntimeError(f"{action.stage} did not write its output {', '.join(missing)}")


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


def _plain(params: Any) -> dict[str, Any]:
    """Return parameters as plain values, or an empty mapping for a stage without any."""
    if params is None:
        return {}
    values = {name: getattr(params, name) for name in params.__dataclass_fields__}
    return {name: list(value) if isinstance(value, tuple) else value for name, value in values.items()}


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


def _peak_memory_mb() -> int:
    """Return the most memory that this process or one of its children held, in MB."""
    peaks = (resource.getrusage(who).ru_maxrss for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return round(max(peaks) / 1024)
