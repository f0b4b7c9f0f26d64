"""How much of a core the main process of a run takes: over a whole run of many sequences and methods, by stand-ins.

    python benchmarks/head.py --sequences 29

The stand-ins take no time, so what the main process needs for planning, starting and ending jobs is seen in minutes.
What it needs while it waits is seen in another run, whose jobs sleep: the least in twenty seconds. Together they tell
its share of a core in a run whose jobs take the seconds of the real ones, which docs/results.md has for a sequence.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import psutil
from kills import make_project

from threedfs.params.configuration import METHODS

SEQUENCE = """\
  s{number}:
    source: resources/sample/video.mp4
    truth: {{masks: resources/sample/masks}}
    settings: {{frames: {{max_frames: {frames}}}}}
"""
EVERY = 0.5
WAITING = 20.0


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--sequences", type=int, default=29)
    parser.add_argument("--methods", type=int, default=13, help="how many, spectral_matting last of all (13)")
    parser.add_argument("--cores", type=int, default=2)
    parser.add_argument("--seconds", type=float, default=330, help="of core that a sequence really takes (330)")
    arguments = parser.parse_args()
    methods = [*(name for name in METHODS if name != "spectral_matting"), "spectral_matting"][: arguments.methods]
    with tempfile.TemporaryDirectory(prefix="threedfs-head-") as folder:
        project = make_project(Path(folder) / "project")
        _write_sequences(project.folder, arguments.sequences, methods)
        idle = _measure_waiting(project, arguments.cores)
        head, wall, jobs = _measure_run(project, arguments.cores)
    real = arguments.sequences * arguments.seconds / arguments.cores
    print(f"{arguments.sequences} sequences, {len(methods)} methods, {jobs} jobs by stand-ins in {wall:.0f} s")
    print(
        f"main process: {head:.0f} s of core, {1000 * head / jobs:.0f} ms a job; waiting {100 * idle:.2f} % of a core"
    )
    print(
        f"real jobs: {real:.0f} s on {arguments.cores} cores, of which it would take {100 * (head / real + idle):.1f} %"
    )


def _write_sequences(folder: Path, count: int, methods: list[str]) -> None:
    """Write a configuration of sequences that have no work in common."""
    text = f"dataset: head\nmethods: [{', '.join(methods)}]\nsequences:\n"
    text += "".join(SEQUENCE.format(number=number, frames=150 - number) for number in range(count))
    (folder / "sequences.yaml").write_text(text)


def _start(project, cores: int, pause: str) -> psutil.Popen:
    """Start a run; what it prints goes to run.log."""
    program = project.command[0]
    with open(project.folder / "run.log", "wb") as log:
        return psutil.Popen(
            [program, "--cores", str(cores), "--configfile", "sequences.yaml"],
            cwd=project.folder,
            env={**project.forking, "STUB_PAUSE": pause},
            stdout=log,
            stderr=subprocess.STDOUT,
        )


def _measure_waiting(project, cores: int) -> float:
    """Return the least share of a core that the main process takes over some seconds while its jobs sleep."""
    running, seen = _start(project, cores, pause="600"), []
    window = int(WAITING / EVERY)
    try:
        while running.poll() is None and len(seen) <= 2 * window:
            if "at work" in (project.folder / "run.log").read_text():
                seen.append(_seconds_of(running))
            time.sleep(EVERY)
    finally:
        running.kill()  # its jobs die with it; told to end, it would wait for them
        running.wait()
    return min(after - before for before, after in zip(seen, seen[window:], strict=False)) / WAITING


def _measure_run(project, cores: int) -> tuple[float, float, int]:
    """Return the seconds of core of the main process, those of the whole run by the wall, and the number of jobs."""
    started, head = time.monotonic(), 0.0
    running = _start(project, cores, pause="0")
    while running.poll() is None:
        head = max(head, _seconds_of(running))
        time.sleep(EVERY)
    said = (project.folder / "run.log").read_text()
    if running.returncode:
        raise SystemExit(said[-3000:])
    return head, time.monotonic() - started, len(re.findall(r": done in ", said))


def _seconds_of(process: psutil.Popen) -> float:
    try:
        times = process.cpu_times()  # its own, without those of its children
    except psutil.NoSuchProcess:
        return 0.0
    return times.user + times.system


if __name__ == "__main__":
    sys.exit(main())
