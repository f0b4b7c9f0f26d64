"""Kill jobs and runs of the workflow at random, and see that nothing damaged is left or believed.

A run is started, one of its jobs or the run itself is sent a signal at a random moment, and it is started again, until
it ends well; then all begins anew. After every kill: no process of the run is left after five seconds, and store and
results hold nothing damaged. After every run that ended well: its results have the bytes of one that nobody disturbed.

The store is the real one. The stages are the stand-ins of the tests; half of the runs fork their jobs, half start them
one by one. With `--real` the stages are the real ones, in the quick preset, and every second time that all begins anew
their kernels are compiled anew too.

    python benchmarks/kills.py --kills 180 --stops 50
    python benchmarks/kills.py --kills 20 --stops 0 --real

`--kills` counts SIGKILLs, `--stops` SIGTERMs and SIGINTs; of both, three in four go to a job, the fourth to the run.
"""

from __future__ import annotations

import argparse
import importlib.util
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import psutil

from threedfs.store.audit import audit_results, audit_store

ROOT = Path(__file__).resolve().parents[1]
WHOM = ("job", "job", "job", "run")
PATIENCE = 5.0
LATEST = 0.4  # of the time that a run takes; each goes on where the one before it was, so every part of it is hit
MARK = "THREEDFS_KILLS"
SEQUENCES = """\
dataset: kills
methods: [fused_sdf]
sequences:
  sample:
    source: {sample}/video.mp4
    cameras: {sample}/cameras.json
    truth: {{masks: {sample}/masks, cameras: {sample}/cameras.json, mesh: {sample}/mesh.ply}}
"""


def main() -> int:
    """Kill as often as asked; print figures, and what went wrong; return 1 if anything did."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--kills", type=int, default=180, help="SIGKILLs to jobs or runs (180)")
    parser.add_argument("--stops", type=int, default=50, help="SIGTERMs and SIGINTs to jobs or runs (50)")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=float("inf"), help="stop after so long")
    parser.add_argument("--target", action="append", default=[], help="a file that each run makes (all)")
    parser.add_argument("--real", action="store_true", help="the real stages")
    arguments = parser.parse_args()
    draw, begun = random.Random(arguments.seed), time.monotonic()
    signals = [signal.SIGKILL] * arguments.kills
    signals += [(signal.SIGTERM, signal.SIGINT)[index % 2] for index in range(arguments.stops)]
    draw.shuffle(signals)
    counts, faults = Counter(), []
    with tempfile.TemporaryDirectory(prefix="threedfs-kills-") as folder:
        project = (make_real_project if arguments.real else make_project)(Path(folder) / "project")
        length, right = _run_undisturbed(project, arguments.target)
        print(f"a run takes {length:.1f} s and makes {len(right)} files", flush=True)
        kernels = _count_kernels(project)
        _begin_anew(project, kernels_too=arguments.real)
        while signals and time.monotonic() - begun < arguments.seconds:
            whom = draw.choice(WHOM)
            environment = project.forking if arguments.real or draw.random() < 0.5 else project.environment
            delay = draw.uniform(0.05, LATEST) * length
            hit, status = _disturb(project, environment, arguments.target, whom, signals[-1], delay)
            if hit:
                counts[f"{whom} {signals.pop().name}"] += 1
                counts["while kernels were missing"] += _count_kernels(project) < kernels
                print(f"{hit}, status {status}, {len(signals)} to go", flush=True)
            found = _find_faults(project)
            if status == 0:
                counts["runs that ended well"] += 1
                found += [f"{name} differs" for name in compare(project.artifacts(), right)]
                _begin_anew(project, kernels_too=counts["runs that ended well"] % 2 == 0)
            for fault in found:
                print(f"FAULT: {fault}", flush=True)
            faults += [f"{hit}: {fault}" for fault in found]
        if (project.folder / "results").is_dir():
            _, files = _run_undisturbed(project, arguments.target)
            counts["runs that ended well"] += 1
            faults += [f"{name} differs" for name in compare(files, right)]
    for name, count in sorted(counts.items()):
        print(f"{name:28}{count:>5}")
    print(f"{'seconds':28}{time.monotonic() - begun:>5.0f}")
    print(*faults, f"faults: {len(faults)}", sep="\n")
    return 1 if faults else 0


def _run_undisturbed(project, files: list[str]) -> tuple[float, dict[str, bytes]]:
    """Return the seconds of a run and what it made."""
    before = time.monotonic()
    project.run(*files)
    return time.monotonic() - before, project.artifacts()


def _count_kernels(project) -> int:
    """Return how many files of compiled kernels its store holds."""
    return sum(file.is_file() for file in (project.folder / "results/.store/kernels").rglob("*"))


def _begin_anew(project, kernels_too: bool) -> None:
    """Take away results and store; leave the kernels there unless told."""
    kernels, aside = project.folder / "results/.store/kernels", project.folder / "kernels"
    if kernels.is_dir() and not kernels_too:
        kernels.rename(aside)
    shutil.rmtree(project.folder / "results")
    if aside.is_dir():
        kernels.parent.mkdir(parents=True)
        aside.rename(kernels)


def compare(found: dict[str, bytes], right: dict[str, bytes]) -> list[str]:
    """Return the names of files that are not the same, or are in one only.

    Snakemake puts its mark into a folder once it has seen the job end; a run that was killed before leaves none.
    """
    names = {name for name in {*found, *right} if not name.endswith("/.snakemake_timestamp")}
    return sorted(name for name in names if found.get(name) != right.get(name))


def _disturb(
    project, environment: dict[str, str], files: list[str], target: str, how: signal.Signals, delay: float
) -> tuple[str, int]:
    """Start a run and send a signal; return whom it was sent to (empty: it had ended before), and the exit status."""
    environment = {**environment, MARK: str(os.getpid()), "STUB_PAUSE": "0.02"}
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    running = subprocess.Popen(
        [*project.command, *files], cwd=project.folder, env=environment, start_new_session=True, **quiet
    )
    until, hit = time.monotonic() + delay, ""
    while time.monotonic() < until and running.poll() is None:
        time.sleep(0.01)
    while running.poll() is None and not hit:
        found = [running.pid] if target == "run" else _jobs_of(running.pid)
        if found:
            try:
                chosen = random.Random(delay).choice(found)
                os.kill(chosen, how)
                hit = f"{how.name} to a {target} after {delay:.1f} s"
            except ProcessLookupError:
                continue
        time.sleep(0.005)
    return hit, running.wait()


def _jobs_of(process: int) -> list[int]:
    """Return the processes below a run: its jobs, their workers and signs of life."""
    try:
        return [child.pid for child in psutil.Process(process).children(recursive=True)]
    except psutil.NoSuchProcess:
        return []


def _find_faults(project) -> list[str]:
    """Return what is wrong after a kill: processes that are left, damage in the store and in results."""
    end = time.monotonic() + PATIENCE
    while (left := _list_left()) and time.monotonic() < end:
        time.sleep(0.05)
    faults = [f"left after {PATIENCE:g} s: {words}" for words in left]
    for process in left:
        psutil.Process(process).kill()
    audit = audit_store(project.folder / "results/.store")
    audit_results(project.folder / "results", audit)
    return faults + audit.damage


def _list_left() -> list[int]:
    """Return the processes of runs that this one has started."""
    found = []
    for process in psutil.process_iter():
        try:
            if process.environ().get(MARK) == str(os.getpid()) and process.status() != psutil.STATUS_ZOMBIE:
                found.append(process.pid)
        except (psutil.NoSuchProcess, psutil.AccessDenied):
            continue
    return found


def make_project(folder: Path):
    """Copy the project, with stand-ins for its stages."""
    return load_stand_ins().make_project(folder)


def make_real_project(folder: Path):
    """Make a folder in which the project's own workflow reconstructs the sample, in small."""

    class RealProject(load_stand_ins().Project):
        """A folder whose runs are those of the project itself."""

        @property
        def command(self) -> list[str]:
            program, *options = super().command
            presets = ["sequences.yaml", str(ROOT / "config/presets/quick.yaml")]
            return [program, "--snakefile", str(ROOT / "Snakefile"), "--configfile", *presets, *options]

        @property
        def environment(self) -> dict[str, str]:
            return self.forking

        @property
        def forking(self) -> dict[str, str]:
            return {**super().forking, "PYTHONPATH": str(ROOT / "src")}

    folder.mkdir()
    (folder / "sequences.yaml").write_text(SEQUENCES.format(sample=ROOT / "resources/sample"))
    return RealProject(folder)


def load_stand_ins():
    path = ROOT / "tests/workflow/conftest.py"
    specification = importlib.util.spec_from_file_location("stand_ins", path)
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module


if __name__ == "__main__":
    sys.exit(main())
