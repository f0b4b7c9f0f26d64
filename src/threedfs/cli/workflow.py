"""Runs the workflow in a folder, in a process of its own."""

from __future__ import annotations

import fcntl
import os
import re
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TextIO

import yaml

from threedfs.cli.earlier import find_costs, measure_size
from threedfs.cli.home import find_home
from threedfs.cli.progress import Progress
from threedfs.cli.request import Request, make_configuration
from threedfs.errors import UserError

_PATIENCE = 15.0
"""Seconds that a run has to end by itself after it was interrupted."""
_FAULT = re.compile(r"threedfs: (\w+ of |configuration|[\w.-]+: )")


@dataclass(frozen=True)
class Outcome:
    """How a run ended.

    Attributes
    ----------
    status : int
        Exit status of Snakemake.
    interrupted : bool
    faults : tuple of str
        Sentences of what failed, without the word `threedfs`.
    log : Path
        All that the run said.
    """

    status: int
    interrupted: bool
    faults: tuple[str, ...]
    log: Path

    @property
    def refused(self) -> bool:
        """Say whether the configuration or what a sequence is given was refused, so that nothing was begun."""
        return any(fault.startswith(("configuration", "inputs of ")) for fault in self.faults)

    def names(self, sequence: str) -> bool:
        """Say whether a fault is one of a sequence's: `STAGE of NAME ITEM: sentence`."""
        pattern = rf"\w+ of {re.escape(sequence)}(?: [^:]*)?: "
        return any(re.match(pattern, fault) for fault in self.faults)


def run_workflow(
    requests: Sequence[Request], changes: Mapping[str, Any], out: Path, quality: str, cores: int
) -> Outcome:
    """Run the workflow for some videos.

    Parameters
    ----------
    requests : sequence of Request
    changes : mapping
        Of the configuration.
    out : Path
        Folder that gets results/.
    quality : str
        One of `QUALITIES`.
    cores : int

    Raises
    ------
    UserError
        If the folder cannot be written to, another run works in it, or it holds results of another file by the
        same name.
    """
    home, log = find_home(), out / "results/logs/run.txt"
    preset = [] if quality == "normal" else [home / "config/presets" / f"{quality}.yaml"]
    chosen = _merge(preset, changes)
    try:
        log.parent.mkdir(parents=True, exist_ok=True)
        with (
            claim(out),
            open(log, "w", encoding="utf-8") as file,
            open(log.with_name("progress.txt"), "w", encoding="utf-8") as journal,
        ):
            before = {_find_request(request, out): _read_request(request, out) for request in requests}
            for path, request in zip(before, requests, strict=True):
                path.parent.mkdir(parents=True, exist_ok=True)
                content = yaml.safe_dump(make_configuration([request], chosen), sort_keys=False)
                path.write_text(content, encoding="utf-8")
            command = [
                *(sys.executable, "-m", "snakemake", "--snakefile", str(home / "Snakefile"), "--directory", str(out)),
                *("--workflow-profile", str(home / "profiles/default")),
                *("--cores", str(cores), "--keep-going", "--configfile", *map(str, before)),
            ]
            costs = find_costs(out, quality, _merge([home / "config/config.yaml"], chosen), cores)
            progress = Progress(costs, journal=journal, measure=lambda name: measure_size(out / "results" / name))
            status, interrupted, said = _follow(command, file, progress)
            faults = dict.fromkeys(line.removeprefix("threedfs: ") for line in said if _FAULT.match(line))
            outcome = Outcome(status, interrupted, tuple(faults), log)
            if outcome.refused:
                _put_back(before)
    except OSError as fault:
        raise UserError(f"--out: expected a folder to write results to, got {out}: {fault.strerror}.") from None
    return outcome


@contextmanager
def claim(out: Path) -> Iterator[None]:
    """Keep other commands out of a folder.

    Raises
    ------
    UserError
        If one is at work in it.
    """
    with open(out / "results/logs/run.lock", "w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise UserError(f"{out}: another run works in this folder; wait for it, or use --out.") from None
        yield


def _find_request(request: Request, out: Path) -> Path:
    """Return where the configuration of a video is, beside its results, for Snakemake and for whoever wonders later."""
    return out / "results" / request.name / "request.yaml"


def _read_request(request: Request, out: Path) -> str | None:
    """Return the configuration that a video was run with before, None if there is none.

    Raises
    ------
    UserError
        If it is of another file.
    """
    path = _find_request(request, out)
    if not path.is_file():
        return None
    text = path.read_text(encoding="utf-8")
    source = (yaml.safe_load(text) or {}).get("sequences", {}).get(request.name, {}).get("source")
    if source not in (None, str(request.source)):
        raise UserError(
            f"{request.source}: expected a name of its own, but {path.parent} holds the results of {source}; rename "
            "the file, or use --out."
        )
    return text


def _put_back(before: Mapping[Path, str | None]) -> None:
    """Let the configurations of earlier runs be as they were."""
    for path, text in before.items():
        if text is None:
            path.unlink()
            if not any(path.parent.iterdir()):
                path.parent.rmdir()
        else:
            path.write_text(text, encoding="utf-8")


def _merge(files: Sequence[Path], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return the configuration that Snakemake would make of files and changes."""
    config: dict[str, Any] = {}
    for part in (*(yaml.safe_load(file.read_text(encoding="utf-8")) for file in files), changes):
        for key, value in part.items():
            both = isinstance(value, dict) and isinstance(config.get(key), dict)
            config[key] = config[key] | value if both else value
    return config


def _follow(command: Sequence[str], log: TextIO, progress: Progress) -> tuple[int, bool, list[str]]:
    """Run a command and follow what it says; return its exit status, whether it was interrupted, and the lines."""
    said, interrupted = [], False
    with _interrupted_by(signal.SIGTERM, signal.SIGHUP):
        running = subprocess.Popen(
            command,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            start_new_session=True,
        )
        try:
            for line in running.stdout or ():
                log.write(line)
                log.flush()
                said.append(line.rstrip())
                progress.follow(line.rstrip())
        except KeyboardInterrupt:
            interrupted = True
            print("\nthreedfs: stopping ...", file=sys.stderr)
            _stop(running)
        except BaseException:
            _stop(running)
            raise
    progress.show(last=True)
    return running.wait(), interrupted, said


@contextmanager
def _interrupted_by(*signals: signal.Signals) -> Iterator[None]:
    """Let signals end a run as Ctrl-C does: it has a session of its own, and would outlive this process."""

    def interrupt(number: int, frame: object) -> None:
        raise KeyboardInterrupt

    before = {}
    if threading.current_thread() is threading.main_thread():  # signals can be handled there only
        # nohup has a hang-up ignored, and so it stays
        before = {each: signal.getsignal(each) for each in signals if signal.getsignal(each) != signal.SIG_IGN}
        for each in before:
            signal.signal(each, interrupt)
    try:
        yield
    finally:
        for each, handler in before.items():
            signal.signal(each, handler)


def _stop(running: subprocess.Popen) -> None:
    """Ask a run to end, and end it and its jobs if it does not."""
    running.send_signal(signal.SIGINT)
    for last in (signal.SIGTERM, signal.SIGKILL):
        try:
            running.communicate(timeout=_PATIENCE)
            return
        except (subprocess.TimeoutExpired, KeyboardInterrupt):
            try:
                os.killpg(running.pid, last)
            except ProcessLookupError:
                return
