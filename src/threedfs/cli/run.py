"""`threedfs run`: from a video to a mesh with one command."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import threading
import time
from argparse import Namespace
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import yaml

from threedfs.cli.home import find_home
from threedfs.cli.progress import SECONDS, Progress, tell_time
from threedfs.cli.request import QUALITIES, Request, list_requests, make_configuration, read_height, read_settings
from threedfs.errors import UserError
from threedfs.report.findings import sum_up
from threedfs.run_end.export import export
from threedfs.run_end.report import find_method, find_out
from threedfs.run_end.results import Results, open_results

_MESHES = {"mesh": "mesh.glb", "detail": "mesh.ply"}
_PATIENCE = 20.0
"""Seconds that a run has to end by itself after it was interrupted."""
_INTERRUPTED = 130


def run(arguments: Namespace) -> int:
    """Reconstruct videos and say where the meshes are; return the exit status.

    Raises
    ------
    UserError
        If something that was asked for cannot be.
    """
    begun = time.monotonic()
    requests, changes = list_requests(arguments.video), read_settings(arguments.set or [])
    height = read_height(arguments.height) if arguments.height else None
    out = Path(arguments.out).expanduser().resolve()
    for request in requests:
        if request.name != request.source.stem:
            print(f"{request.source.name} is called {request.name} in the results.")
    status, said = _reconstruct(requests, changes, out, arguments.quality, arguments.cores)
    if status == _INTERRUPTED:
        print("threedfs: not finished; the same command goes on where it was stopped.", file=sys.stderr)
        return status
    faults = [line for line in said if line.startswith("threedfs: ")]
    failed = [request for request in requests if any(_is_of(request.name, line) for line in faults)]
    for request in requests:
        # after a failure, meshes may be of an earlier run; a sequence that is not named has ended well
        if not status or (failed and request not in failed):
            _conclude(request, out, height)
    if not status:
        print(f"time     {tell_time(time.monotonic() - begun)}")
    for sentence in dict.fromkeys(faults):
        print(sentence, file=sys.stderr)
    if status and not faults:
        print(f"threedfs: the run failed; its last words are in {_log_of(out, requests)}.", file=sys.stderr)
    return 1 if status else 0


def reconstruct(
    video: str | Path,
    out: str | Path = ".",
    *,
    quality: str = "normal",
    cores: int | None = None,
    settings: Mapping[str, Any] | None = None,
) -> Results:
    """Reconstruct the object of a video, or of a folder of photos; what was done before is not done again.

    Parameters
    ----------
    video : str or Path
    out : str or Path
        Folder that gets `results/NAME`.
    quality : str
        draft, normal or fine.
    cores : int, optional
        All, if not given.
    settings : mapping, optional
        Parameters that differ from the defaults, by stage: `{"depth": {"iterations": 5}}`.

    Raises
    ------
    UserError
        If the run failed, with the sentence that says why.
    """
    if quality not in QUALITIES:
        raise UserError(f"quality: expected one of {', '.join(QUALITIES)}, got {quality}.")
    requests, folder = list_requests([str(video)]), Path(out).expanduser().resolve()
    status, said = _reconstruct(requests, dict(settings or {}), folder, quality, cores or os.cpu_count() or 1)
    if status == _INTERRUPTED:
        raise KeyboardInterrupt
    if status:
        faults = [line.removeprefix("threedfs: ") for line in said if line.startswith("threedfs: ")]
        raise UserError(" ".join(dict.fromkeys(faults)) or f"the run failed; see {_log_of(folder, requests)}.")
    return open_results(folder / "results" / requests[0].name)


def _reconstruct(
    requests: Sequence[Request], changes: dict, out: Path, quality: str, cores: int
) -> tuple[int, list[str]]:
    """Run the workflow in a folder; return its exit status and all that it said."""
    home = find_home()
    log = _log_of(out, requests)
    try:
        log.parent.mkdir(parents=True, exist_ok=True)
        asked = log.with_name("request.yaml")
        asked.write_text(yaml.safe_dump(make_configuration(requests, changes), sort_keys=False), encoding="utf-8")
    except OSError as fault:
        raise UserError(f"--out: expected a folder to write results to, got {out}: {fault.strerror}.") from None
    preset = [] if quality == "normal" else [str(home / "config/presets" / f"{quality}.yaml")]
    command = [
        *(sys.executable, "-m", "snakemake", "--snakefile", str(home / "Snakefile"), "--directory", str(out)),
        *("--workflow-profile", str(home / "profiles/default")),
        *("--cores", str(cores), "--keep-going", "--configfile", *preset, str(asked)),
    ]
    progress, said, stopped = Progress(SECONDS[quality]), [], False
    running = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace", start_new_session=True
    )
    with open(log, "w", encoding="utf-8") as file, _interrupted_by(signal.SIGTERM, signal.SIGHUP):
        try:
            for line in running.stdout:
                file.write(line)
                file.flush()
                said.append(line.rstrip())
                progress.follow(line.rstrip())
        except KeyboardInterrupt:
            stopped = True
            _stop(running)
    status = running.wait()
    progress.show(last=True)
    return (_INTERRUPTED if stopped else status), said


@contextmanager
def _interrupted_by(*signals: signal.Signals) -> Iterator[None]:
    """Let signals end a run as Ctrl-C does: it has a session of its own, and would outlive this process."""

    def interrupt(number: int, frame: object) -> None:
        raise KeyboardInterrupt

    here = threading.current_thread() is threading.main_thread()  # signals can be handled there only
    before = {each: signal.signal(each, interrupt) for each in signals} if here else {}
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
            os.killpg(running.pid, last)


def _is_of(name: str, sentence: str) -> bool:
    """Say whether a sentence is of a job of a sequence: `threedfs: STAGE of NAME ITEM: ...`."""
    return re.match(rf"threedfs: \w+ of {re.escape(name)}(?: [^:]*)?: ", sentence) is not None


def _log_of(out: Path, requests: Sequence[Request]) -> Path:
    return out / "results" / requests[0].name / "run.txt"


def _conclude(request: Request, out: Path, height: float | None) -> None:
    """Say what a run made of a video, and write the files for printing if its height is known."""
    folder = out / "results" / request.name
    method = find_method(folder)
    if method is None:
        return
    meshes = {what: folder / "11_object" / method / name for what, name in _MESHES.items()}
    for what, path in meshes.items():
        if path.is_file():
            print(f"{what:8} {path}")
    if height is not None:
        for ending, unit, size in ((".stl", "mm", height), (".glb", "m", height / 1000)):
            file = out / f"{request.name}{ending}"
            export(folder, str(size), file, method)
            print(f"{ending[1:]:8} {file}, {size:g} {unit} tall")
    masks = folder / "11_object/gc_2d3d_pixel/masks"
    if masks.is_dir():
        print(f"masks    {masks}, {len(list(masks.glob('*.png')))} of them")
    if (folder / "report.html").is_file():
        print(f"report   {folder / 'report.html'}")
    try:
        findings = find_out(folder)
    except (UserError, KeyError, ValueError, OSError) as fault:  # results were damaged: the meshes are named above
        print(f"verdict  none, as results cannot be read: {fault}")
        return
    print(f"verdict  {sum_up(findings)}")
    for finding in findings:
        if not finding.good:
            print(f"         {finding.advice}")
