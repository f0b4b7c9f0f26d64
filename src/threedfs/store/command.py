"""Run one job of the workflow: its log, its last lines, its exit status."""

from __future__ import annotations

import errno
import sys
import time
import traceback
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, TextIO, cast

from threedfs.errors import UserError
from threedfs.progress import Progress
from threedfs.store.action import Inputs, Task
from threedfs.store.arguments import fit_inputs, read_arguments
from threedfs.store.each import Chain, Fault, Passage, perform_each
from threedfs.store.perform import perform
from threedfs.store.place import Store, explained
from threedfs.store.results import read_result

_NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EFBIG)


class Tee:
    """Writes whole lines to several streams, so that those of jobs that run at once do not mix."""

    def __init__(self, *streams: TextIO) -> None:
        self.streams = streams
        self._line = ""

    def write(self, text: str) -> int:
        """Take text; every line goes out when it ends."""
        self._line += text
        done, end, self._line = self._line.rpartition("\n")
        for stream in self.streams:
            stream.write(done + end)
        return len(text)

    def flush(self) -> None:
        """Flush every stream."""
        for stream in self.streams:
            stream.flush()


def run_job(
    stage: str,
    inputs: Inputs,
    outputs: Mapping[str, Path],
    settings: Mapping[str, Any],
    wildcards: Mapping[str, str],
    labels: Mapping[str, Any],
    *,
    store: Path,
    log: Path,
    threads: int,
    seed: int,
    refusal: str = "",
    modules: Sequence[str] = (),
    package: str = "threedfs",
    fallback: Path | None = None,
    made: Path | None = None,
) -> None:
    """Perform one job and exit with status 1 if it fails.

    What the user got wrong ends in one sentence, on the terminal and in the log; any other fault in a traceback.

    Parameters
    ----------
    stage, inputs, outputs, settings, seed, modules, package
        As a `Task` has them; of a folder with one file for each keyframe, a stage may take the list of files.
    wildcards : mapping of str to str
        All wildcards of the rule. The sequence only names the job in messages, so that two sequences of the same
        content share their work.
    labels : mapping of str to JSON values
        What the configuration says of this sequence, names that a stage writes into its output among it; given to the
        stage like wildcards. All of it counts.
    store, log : Path
    threads : int
    refusal : str
        Why the job cannot be done, if that is known before.
    fallback, made : Path or None
        As a `Store` has them.
    """
    started = time.monotonic()
    identity = {name: value for name, value in wildcards.items() if name != "sequence"}
    label = f"{stage} of {' '.join([_name_sequence(wildcards), *identity.values()])}"
    with _logged(log, label) as (file, streams):
        if refusal:
            raise UserError(refusal)
        arguments = read_arguments(f"{package}.stages.{stage}")
        given = inputs.get("keyframes")
        order = read_result(cast(Path, given), Store(store, fallback, made))["order"] if given else None
        fitting = fit_inputs(arguments, inputs, order=order)
        task = Task(stage, fitting, outputs, settings, {**identity, **labels}, seed, modules, package)
        progress = Progress(label, streams)
        outcome = perform(task, store, progress=progress, threads=threads, fallback=fallback, made=made)
        how = "taken from the store" if outcome.hit else "done"
        progress.note(f"{how} in {time.monotonic() - started:.1f} s")
        _name_actions([outcome.key], file)


def run_keyframes(
    rule: str,
    stages: Sequence[str],
    inputs: Inputs,
    outputs: Mapping[str, Path],
    settings: Mapping[str, Mapping[str, Any]],
    wildcards: Mapping[str, str],
    labels: Mapping[str, Any],
    *,
    store: Path,
    log: Path,
    threads: int,
    seed: int,
    keyframes: Sequence[str] | None = None,
    package: str = "threedfs",
    fallback: Path | None = None,
    made: Path | None = None,
) -> None:
    """Perform a chain of stages for every keyframe and exit with status 1 if any of it fails.

    Keyframes that are refused are told at the end, after the others are done.

    Parameters
    ----------
    rule : str
        Names the job in messages.
    stages, inputs, outputs, settings, labels, seed, package
        As a `Chain` has them; `keyframes` among the inputs is keyframes.json.
    wildcards : mapping of str to str
        The sequence, which only names the job.
    store, log : Path
    threads : int
        Keyframes worked on at once.
    keyframes : sequence of str or None
        Those to work on, if not all.
    fallback, made : Path or None
        As a `Store` has them.
    """
    sequence = _name_sequence(wildcards)
    with _logged(log, f"{rule} of {sequence}") as (file, streams):
        place = Store(store, fallback, made)
        order = read_result(cast(Path, inputs["keyframes"]), place)["order"]
        with explained(store):
            found = perform_each(
                Chain(tuple(stages), inputs, outputs, settings, labels, seed, package),
                order if keyframes is None else keyframes,
                order,
                place,
                announce=lambda stage, keyframe: Progress(f"{stage or rule} of {sequence} {keyframe}", streams),
                threads=threads,
            )
        _name_actions([outcome.key for passage in found.values() for outcome in passage.outcomes], file)
        faults = _gather_faults(found)
        for fault, names in faults.items():
            others = f" and {len(names) - 1} more" if len(names) > 1 else ""
            label = f"{fault.stage or rule} of {sequence} {names[0]}{others}"
            told = (
                f"threedfs: {label}: {_strip(fault.sentence, label)}"
                if fault.sentence
                else f"{label}:\n{fault.trace.rstrip()}"
            )
            print(told, file=streams)
    if faults:
        sys.exit(1)


def _strip(sentence: str, label: str) -> str:
    """Return a sentence without the stage before it, which the label tells."""
    return sentence.removeprefix(f"{label.partition(' of ')[0]}: ")


def _gather_faults(found: Mapping[str, Passage]) -> dict[Fault, list[str]]:
    """Return each fault once, with the keyframes that have it."""
    faults = defaultdict(list)
    for keyframe, passage in found.items():
        if passage.fault:
            faults[passage.fault].append(keyframe)
    return dict(faults)


def _name_sequence(wildcards: Mapping[str, str]) -> str:
    return wildcards.get("sequence", "all sequences")


def _name_actions(keys: Sequence[str], log: TextIO) -> None:
    """Write into the log what was done; it ends with that if all went well."""
    log.writelines(f"action {key}\n" for key in keys or ["none"])


@contextmanager
def _logged(log: Path, label: str) -> Iterator[tuple[TextIO, Tee]]:
    """Give the log, and what writes to it and the terminal; a fault goes there, and ends the process with status 1."""
    log.parent.mkdir(parents=True, exist_ok=True)
    with open(log, "w", encoding="utf-8") as file:
        streams = Tee(file, sys.stderr)
        try:
            yield file, streams
        except UserError as fault:
            print(f"threedfs: {label}: {_strip(str(fault), label)}", file=streams)
            sys.exit(1)
        except OSError as fault:
            if fault.errno not in _NO_ROOM:
                traceback.print_exc(file=file)
                raise
            where = f" at {fault.filename}" if fault.filename else ""
            told = f"expected room to write to, got: {fault.strerror}{where}; free some, and run again."
            print(f"threedfs: {label}: {told}", file=sys.stderr)
            with suppress(OSError):  # the log may lie on the same disk
                print(f"threedfs: {label}: {told}", file=file, flush=True)
            sys.exit(1)
        except BaseException:
            traceback.print_exc(file=file)
            raise
