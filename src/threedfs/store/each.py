"""Stages that work on one keyframe, done for all keyframes in one job.

Every stage of every keyframe is an action of its own in the store, so that a killed job goes on where it was.
"""

from __future__ import annotations

import time
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from threedfs.errors import UserError
from threedfs.job import Job
from threedfs.progress import Progress
from threedfs.store.action import Action, Inputs, Task, identify, identify_maker
from threedfs.store.arguments import SUFFIX, fit_inputs, read_arguments
from threedfs.store.files import remove
from threedfs.store.heartbeat import beating
from threedfs.store.made import Made
from threedfs.store.perform import Outcome, fetch, load_stages, make, obtain
from threedfs.store.place import Store, explained
from threedfs.store.workers import Death, share_out

Announce = Callable[[str, str], Progress]
"""Returns what takes the notes of a stage, or of the whole chain (no name), on a keyframe."""


@dataclass(frozen=True)
class Chain:
    """Stages that are done one after the other on each keyframe.

    Attributes
    ----------
    stages : tuple of str
    inputs : mapping of str to Path, list of Path, or None
        Each stage is given those that its `run` names; of a folder with one file for each keyframe, what it takes.
    outputs : mapping of str to Path
        Folders, for files named after the keyframes; each is the output of the first stage that names it, and an
        input of those after it.
    settings : mapping of str to mapping
        Every parameter of every stage.
    labels : mapping of str to JSON values
        Given to the stages that name them, like wildcards.
    seed : int
    package : str
        Where stages are looked up.
    """

    stages: tuple[str, ...]
    inputs: Inputs
    outputs: Mapping[str, Path]
    settings: Mapping[str, Mapping[str, Any]]
    labels: Mapping[str, Any] = field(default_factory=dict)
    seed: int = 0
    package: str = "threedfs"

    def tasks(self, keyframe: str, order: Sequence[str]) -> list[Task]:
        """Return what each stage is to do on one of the keyframes, which come in an order."""
        tasks, inputs, left = [], dict(self.inputs), dict(self.outputs)
        for stage in self.stages:
            takes = read_arguments(f"{self.package}.stages.{stage}")
            own = {name: left.pop(name) / f"{keyframe}{SUFFIX}" for name in [*left] if name in takes}
            task = Task(
                stage,
                fit_inputs(takes, inputs, keyframe, order),
                own,
                self.settings[stage],
                {"keyframe": keyframe, **{name: self.labels[name] for name in self.labels if name in takes}},
                self.seed,
                package=self.package,
            )
            tasks.append(task)
            inputs |= own
        return tasks


@dataclass(frozen=True)
class Fault:
    """Why a stage has no result on a keyframe.

    Attributes
    ----------
    stage : str
        Empty if that is not known.
    sentence : str
        For the user; empty if the program is at fault.
    trace : str
        Then, where.
    """

    stage: str
    sentence: str
    trace: str = ""


@dataclass(frozen=True)
class Passage:
    """How far a keyframe has come through the chain.

    Attributes
    ----------
    outcomes : tuple of Outcome
        Of the stages that are done.
    fault : Fault or None
        What stopped it after those.
    """

    outcomes: tuple[Outcome, ...] = ()
    fault: Fault | None = None


def perform_each(
    chain: Chain, keyframes: Sequence[str], order: Sequence[str], store: Store, *, announce: Announce, threads: int
) -> dict[str, Passage]:
    """Put the outputs of a chain in place for all keyframes, from the store or by running the stages.

    What the store has is taken first, by this process. For the others the stages are imported once and `threads`
    processes are forked, each of which does one keyframe after the other, on one thread. Files that belong to no
    keyframe are removed. If a stage refuses a keyframe, the others are done all the same; a fault of the program ends
    the work.

    Parameters
    ----------
    chain : Chain
    keyframes : sequence of str
        Those to work on.
    order : sequence of str
        All keyframes, in the order in which stages that read several are given them.
    store : Store
    announce : callable
    threads : int

    Returns
    -------
    dict of str to Passage
        By keyframe, in their order, without those that were not come to.
    """
    for folder in chain.outputs.values():
        _clear(folder, {f"{keyframe}{SUFFIX}" for keyframe in keyframes})
        if store.made is not None:
            Made(store.made).forget(folder)  # its files are noted one by one
    found: dict[str, Passage] = {}

    def tell(keyframe: str, how: str, seconds: float) -> None:
        announce("", keyframe).note(f"{how} in {seconds:.1f} s ({len(found)}/{len(keyframes)})")

    def announce_of(keyframe: str) -> Callable[[str], Progress]:
        return lambda stage: announce(stage, keyframe)

    reached: dict[str, tuple[Outcome, ...]] = {}
    for keyframe in keyframes:
        started = time.monotonic()
        outcomes = _fetch_first(chain.tasks(keyframe, order), store, announce_of(keyframe))
        if len(outcomes) == len(chain.stages):
            found[keyframe] = Passage(outcomes)
            tell(keyframe, "taken from the store", time.monotonic() - started)
        else:
            reached[keyframe] = outcomes
    if not reached:
        return found
    with beating(store.claims) as beat:
        first = min(map(len, reached.values()))
        modules = [f"{chain.package}.stages.{stage}" for stage in chain.stages[first:]]
        reason = load_stages({module: identify_maker(module) for module in modules}, store.folder, 1)
        if reason:
            announce("", next(iter(reached))).note(reason)
        _confirm_inputs(chain, next(iter(reached)), order, reached, store, announce)

        def work(keyframe: str) -> tuple[Passage, float]:
            started = time.monotonic()
            tasks = chain.tasks(keyframe, order)[len(reached[keyframe]) :]
            rest = _pass_through(tasks, store, beat, announce_of(keyframe))
            return Passage((*reached[keyframe], *rest.outcomes), rest.fault), time.monotonic() - started

        for keyframe, answer in share_out(work, list(reached), threads):
            if isinstance(answer, Death):
                found[keyframe] = Passage(reached[keyframe], Fault("", str(answer)))
                continue
            found[keyframe], seconds = answer
            fault = found[keyframe].fault
            tell(keyframe, "not done, stopped" if fault else "done", seconds)
            if fault and fault.trace:
                break
    return {keyframe: found[keyframe] for keyframe in keyframes if keyframe in found}


def _fetch_first(tasks: Sequence[Task], store: Store, announce: Callable[[str], Progress]) -> tuple[Outcome, ...]:
    """Take from the store what the first stages made, up to the first that it has not."""
    outcomes = []
    for task in tasks:
        progress = announce(task.stage)
        outcome = fetch(identify(task, store.digests(progress)), store, progress)
        if outcome is None:
            break
        outcomes.append(outcome)
    return tuple(outcomes)


def _confirm_inputs(
    chain: Chain,
    keyframe: str,
    order: Sequence[str],
    reached: Mapping[str, tuple[Outcome, ...]],
    store: Store,
    announce: Announce,
) -> None:
    """Look at the bytes of what all keyframes' work reads, once for all workers."""
    task = chain.tasks(keyframe, order)[len(reached[keyframe])]
    try:
        identify(task, store.digests(announce(task.stage, keyframe), thorough=True))
    except UserError:  # the worker says so
        pass


def _pass_through(tasks: Sequence[Task], store: Store, beat: Path, announce: Callable[[str], Progress]) -> Passage:
    """Do stages that are loaded, one after the other, up to the first that fails."""
    outcomes: list[Outcome] = []
    for task in tasks:
        started, progress = time.monotonic(), announce(task.stage)

        def work(action: Action, progress: Progress = progress, started: float = started) -> Outcome:
            return make(action, store, Job(progress, action.header, 1, action.task.seed), started)

        try:
            with explained(store.folder):
                action = identify(task, store.digests(progress))
                outcome = fetch(action, store, progress) or obtain(action, store, beat, progress, work)
        except UserError as fault:
            return Passage(tuple(outcomes), Fault(task.stage, str(fault)))
        except Exception:
            return Passage(tuple(outcomes), Fault(task.stage, "", traceback.format_exc()))
        outcomes.append(outcome)
    return Passage(tuple(outcomes))


def _clear(folder: Path, names: set[str]) -> None:
    """Make a folder, and remove from it what does not belong there."""
    folder.mkdir(parents=True, exist_ok=True)
    for path in folder.iterdir():
        if path.name not in names:
            remove(path)
