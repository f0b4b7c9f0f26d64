"""Run one job of the workflow: its log, its last line, its exit status."""

from __future__ import annotations

import sys
import traceback
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TextIO

from threedfs.errors import UserError
from threedfs.progress import Progress
from threedfs.store.perform import Inputs, perform


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
) -> None:
    """Perform one job and exit with status 1 if it fails.

    What the user got wrong ends in one sentence, on the terminal and in the log; any other fault in a traceback.

    Parameters
    ----------
    stage, inputs, outputs, settings, store, threads, seed, modules
        As `perform` takes them.
    wildcards : mapping of str to str
        All wildcards of the rule. The sequence only names the job in messages, so that two sequences of the same
        content share their work.
    labels : mapping of str to JSON values
        What the configuration says of this sequence, names that a stage writes into its output among it; given to the
        stage like wildcards. All of it counts.
    log : Path
    refusal : str
        Why the job cannot be done, if that is known before.
    """
    identity = {name: value for name, value in wildcards.items() if name != "sequence"}
    label = " ".join([wildcards.get("sequence", "all sequences"), *identity.values()])
    log.parent.mkdir(parents=True, exist_ok=True)
    with open(log, "w", encoding="utf-8") as file:
        progress = Progress(f"{stage} of {label}", Tee(file, sys.stderr))
        try:
            if refusal:
                raise UserError(refusal)
            outcome = perform(
                stage,
                inputs,
                outputs,
                settings,
                {**identity, **labels},
                store,
                progress=progress,
                threads=threads,
                seed=seed,
                modules=modules,
            )
        except UserError as fault:
            print(f"threedfs: {stage} of {label}: {fault}", file=Tee(file, sys.stderr))
            sys.exit(1)
        except BaseException:
            traceback.print_exc(file=file)
            raise
        how = "taken from the store" if outcome.hit else "done"
        progress.note(f"{how} in {outcome.seconds:.1f} s")
        print(f"action {outcome.key}", file=file)
