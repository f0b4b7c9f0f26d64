"""Run a small reconstruction on a private Slurm and on this machine, and compare every byte of the results.

    python tests/cluster/run_cluster.py
    python tests/cluster/run_cluster.py --stubs --fault head

With `--stubs` the stages are stand-ins that write a few bytes, so that nothing but the workflow is tried.

Faults, while jobs run: `scancel` cancels one, `node` kills a node and what runs on it, `head` kills the Snakemake that
submits, `memory` asks for too little of it, `disk` fills the disk of the results, `readonly` lets nothing be written to
the store. After each, the same command is given again if the run failed; what was finished must not be computed again.
"""

from __future__ import annotations

import argparse
import importlib.util
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from private_slurm import NODES, PrivateSlurm, can_install, find_missing, install

ROOT = Path(__file__).resolve().parents[2]
SAMPLE = ROOT / "resources" / "sample"
FAULTS = ("scancel", "node", "head", "memory", "disk", "readonly")

_SEQUENCES = """\
dataset: cluster
methods: [fused_sdf]
store: {store}
sequences:
"""
_SEQUENCE = """\
  {name}:
    source: {sample}/video.mp4
    cameras: {sample}/cameras.json
    truth: {{masks: {sample}/masks, cameras: {sample}/cameras.json, mesh: {sample}/mesh.ply}}
    settings: {{frames: {{max_frames: {frames}}}}}
"""


class Failure(Exception):
    """What a run on the cluster should have done and did not."""


@dataclass
class Project:
    """A folder in which the workflow runs.

    Attributes
    ----------
    folder : Path
    environment : dict of str to str
    options : list of str
        Of every command.
    stubs : bool
        Whether its stages are stand-ins, in a copy of the workflow.
    """

    folder: Path
    environment: dict[str, str]
    options: list[str]
    stubs: bool = False

    @property
    def home(self) -> Path:
        """Where the Snakefile is."""
        return self.folder if self.stubs else ROOT

    def prepare(self, sequences: int, store: str = "results/.store", kernels: Path | None = None) -> None:
        """Write the configuration; copy compiled kernels into the store, if there are any."""
        if self.stubs:
            _load_stand_ins().make_project(self.folder)
            self.environment |= {"PYTHONPATH": f"{self.folder / 'src'}:{self.environment['PYTHONPATH']}"}
        sample = "resources/sample" if self.stubs else SAMPLE
        text = _SEQUENCES.format(store=store)
        text += "".join(_SEQUENCE.format(name=f"s{n}", sample=sample, frames=24 - n) for n in range(sequences))
        (self.folder / store).mkdir(parents=True, exist_ok=True)
        if kernels and kernels.is_dir():
            shutil.copytree(kernels, self.folder / store / "kernels")
        (self.folder / "sequences.yaml").write_text(text)

    def start(self) -> subprocess.Popen:
        """Start Snakemake; what it prints goes to run.log."""
        with open(self.folder / "run.log", "ab") as log:
            return subprocess.Popen(
                [
                    *(sys.executable, "-m", "snakemake", "--snakefile", str(self.home / "Snakefile")),
                    *self.options,
                    *("--configfile", "sequences.yaml", str(ROOT / "config/presets/quick.yaml")),
                ],
                cwd=self.folder,
                env=self.environment,
                stdout=log,
                stderr=log,
                start_new_session=True,
            )

    def log(self) -> str:
        """Return all that its runs have printed."""
        return (self.folder / "run.log").read_text()

    def artifacts(self) -> dict[str, bytes]:
        """Return the results by name, without logs and costs, which differ from run to run."""
        results = self.folder / "results"
        left_out = {"logs", "benchmarks", ".store", "report.html", "tables", "plots"}
        files = (file for file in sorted(results.rglob("*")) if file.is_file())
        names = ((file.relative_to(results), file) for file in files)
        return {name.as_posix(): file.read_bytes() for name, file in names if not left_out & set(name.parts)}

    def finished_work(self) -> dict[str, int]:
        """Return when each action in the store was recorded."""
        stores = [*self.folder.glob("*store/actions"), *self.folder.glob("results/.store/actions")]
        return {file.name: file.stat().st_mtime_ns for store in stores for file in store.rglob("*.json")}


def make_options(arguments: argparse.Namespace) -> list[str]:
    """Return Snakemake's options for the cluster: the profile, and what suits small nodes and jobs of seconds."""
    each = ("scout", "cues", "depth", "stereo", "stereo_check")
    options = ["--profile", str(ROOT / "profiles/slurm"), "--latency-wait", "10"]
    options += ["--slurm-init-seconds-before-status-checks", "6", "--set-threads", *(f"{rule}=2" for rule in each)]
    if arguments.arrays:
        options += ["--slurm-array-jobs", "all"]
    if arguments.fault == "memory":
        options += ["--set-resources", f"{arguments.strike}:mem_mb=110*4**(attempt-1)"]
    return options


def _load_stand_ins():
    """Return the module of the workflow's tests that makes a project of stand-ins."""
    spec = importlib.util.spec_from_file_location("stand_ins", ROOT / "tests/workflow/conftest.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def wait_for_job(slurm: PrivateSlurm, head: subprocess.Popen, rule: str, seconds: float = 900) -> str:
    """Return the number of a job of a rule once it has run for a second or two."""
    end = time.monotonic() + seconds
    while time.monotonic() < end and head.poll() is None:
        for line in slurm.query("squeue", "-h", "-t", "R", "-o", "%i %k %M").splitlines():
            job, comment, passed = line.split()
            if comment.startswith(f"rule_{rule}_wildcards") and passed not in ("0:00", "0:01"):
                return job
        time.sleep(0.2)
    raise Failure(f"expected a running job of rule {rule}, but none came")


def strike(fault: str, rule: str, slurm: PrivateSlurm, project: Project, head: subprocess.Popen) -> None:
    """Let a fault happen to a running job."""
    if not fault:
        return
    job = wait_for_job(slurm, head, rule)  # one that has too little memory needs no more
    if fault == "scancel":
        slurm.query("scancel", job)
    elif fault == "node":
        slurm.kill_node(slurm.query("squeue", "-h", "-j", job, "-o", "%N"))
    elif fault == "head":
        head.kill()
    elif fault == "disk":
        disk = project.folder / "disk"
        _remount(disk, f"size={shutil.disk_usage(disk).used // 1024}k")
    elif fault == "readonly":
        _remount(project.folder / "disk", "ro", patience=60)
    print(f"{time.strftime('%H:%M:%S')} {fault}: job {job} of rule {rule}", flush=True)


def mend(fault: str, slurm: PrivateSlurm, project: Project) -> None:
    """Undo a fault that does not pass by itself."""
    if fault == "disk":
        _remount(project.folder / "disk", "size=1g")
    elif fault == "readonly":
        _remount(project.folder / "disk", "rw")
    elif fault == "node":
        for node in NODES:
            if slurm.query("sinfo", "-h", "-n", node, "-o", "%T") not in ("idle", "mixed", "allocated"):
                slurm.start_node(node)


def run_with_fault(arguments: argparse.Namespace, slurm: PrivateSlurm, project: Project) -> None:
    """Run on the cluster, with the fault, and give the command again if the first run did not end well."""
    head = project.start()
    try:
        strike(arguments.fault, arguments.strike, slurm, project, head)
        before = project.finished_work()
        status = head.wait(1800)
        told = project.log()
        print(f"the run ended with status {status}", flush=True)
        if (status != 0) != (arguments.fault in ("head", "disk", "readonly")):
            raise Failure(f"expected another exit status of the run than {status}:\n{told[-3000:]}")
        if status != 0:
            mend(arguments.fault, slurm, project)
            before = project.finished_work()
            head = project.start()
            status = head.wait(1800)
            print(f"the same command, given again, ended with status {status}", flush=True)
            if status != 0:
                raise Failure(f"expected that the same command ends the run:\n{project.log()[-3000:]}")
    finally:
        if head.poll() is None:
            os.killpg(head.pid, signal.SIGTERM)
            head.wait()
    after = project.finished_work()
    again = [key for key, when in before.items() if after.get(key) != when]
    print(f"{len(before)} actions were finished at the fault, {len(again)} of them computed again; {len(after)} in all")
    if again:
        raise Failure(f"expected that nothing finished is computed again, found {len(again)} actions that were")


def compare(local: Project, cluster: Project, target: str | None) -> None:
    """Compare the results, byte for byte; with a target, those that the cluster made on the way to it."""
    ours, theirs = local.artifacts(), cluster.artifacts()
    if target:
        ours = {name: content for name, content in ours.items() if name in theirs}
    differing = sorted(name for name in {*ours, *theirs} if ours.get(name) != theirs.get(name))
    if differing or not ours:
        raise Failure(
            f"expected the same bytes from the cluster, found {len(differing)} others: {', '.join(differing)}"
        )
    print(f"{len(ours)} files, {sum(map(len, ours.values())) / 1e6:.1f} MB: the same bytes as by a local run")


def report(slurm: PrivateSlurm, project: Project, seconds: float) -> None:
    """Print Slurm's log of ended jobs, and how many there were."""
    records = [dict(field.split("=", 1) for field in line.split() if "=" in field) for line in slurm.completed()]
    for record in records:
        print(*(record.get(name, "") for name in ("JobId", "JobState", "StartTime", "EndTime", "NodeList", "Tres")))
    failed = any(record["JobState"] != "COMPLETED" for record in records)
    # Slurm's plugin keeps the logs of failed jobs, and of all jobs in arrays
    for said in sorted((project.folder / ".snakemake/slurm_logs").rglob("*.log")) if failed else ():
        print(f"--- {said.name}:", *said.read_text().splitlines()[-40:], sep="\n    ")
    log = project.log()
    single, arrays = log.count("has been submitted with SLURM jobid"), log.count("Submitted array job")
    states = ", ".join(f"{count} {state.lower()}" for state, count in Counter(r["JobState"] for r in records).items())
    print(f"{single + arrays} submissions ({arrays} of arrays), {len(records)} jobs: {states}; {seconds:.0f} s")


@contextmanager
def small_disk(folder: Path) -> Iterator[None]:
    """Put a file system of memory at a folder, whose size and rights a fault changes."""
    folder.mkdir()
    subprocess.run(["mount", "-t", "tmpfs", "-o", "size=1g", "tmpfs", str(folder)], check=True)
    try:
        yield
    finally:
        subprocess.run(["umount", "--lazy", str(folder)], check=False)


def _remount(folder: Path, option: str, patience: float = 5) -> None:
    end = time.monotonic() + patience
    while True:  # a file that is open for writing keeps it from turning read-only
        done = subprocess.run(["mount", "-o", f"remount,{option}", str(folder)], capture_output=True, check=False)
        if done.returncode == 0:
            return
        if time.monotonic() > end:
            raise Failure(f"{folder}: cannot be mounted with {option}: {done.stderr.decode().strip()}")
        time.sleep(0.02)


def main() -> int:
    """Run what the command line asks for; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--fault", choices=FAULTS, default="", help="what is to go wrong")
    parser.add_argument("--strike", default="depth", metavar="RULE", help="whose job meets the fault (depth)")
    parser.add_argument("--sequences", type=int, default=1, help="copies of the sample, a frame apart (1)")
    parser.add_argument("--arrays", action="store_true", help="submit jobs of one rule as arrays")
    parser.add_argument("--stubs", action="store_true", help="stand-ins for the stages")
    parser.add_argument("--target", help="a result to make, without results/s0/, as 03_scene/volume.zarr.zip (all)")
    parser.add_argument("--local", type=Path, help="folder that keeps the local run between runs")
    parser.add_argument("--install", action="store_true", help="install Debian's Slurm and munge if they are missing")
    arguments = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # so that all that was started is stopped
    if find_missing() and arguments.install and can_install():
        install()
    if find_missing():
        hint = "run as root with --install, or install the packages slurm-wlm and munge"
        print(f"expected the programs {', '.join(find_missing())}, found none of them; {hint}.", file=sys.stderr)
        return 1
    try:
        run(arguments)
    except Failure as fault:
        print(f"FAILED: {fault}", file=sys.stderr)
        return 1
    return 0


def run(arguments: argparse.Namespace) -> None:
    """Run locally, then on a Slurm of its own, and compare.

    Raises
    ------
    Failure
        If results differ, a run does not end as it should, or finished work is done again.
    """
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="cluster-", ignore_cleanup_errors=True)))
        targets = [f"results/s{n}/{arguments.target}" for n in range(arguments.sequences) if arguments.target]
        base = {**os.environ, "PYTHONPATH": f"{ROOT / 'src'}:{os.environ.get('PYTHONPATH', '')}"}
        kept = arguments.local or folder / "local"
        local = Project(kept, dict(base), [*targets, "--cores", "2"], arguments.stubs)
        if not (kept / "run.log").exists():
            local.prepare(arguments.sequences)
            if local.start().wait():
                raise Failure(f"expected that the local run ends well:\n{local.log()[-3000:]}")
        slurm = stack.enter_context(PrivateSlurm(folder / "slurm"))
        environment = base | slurm.environment | {"STUB_PAUSE": "4" if arguments.fault else "0"}
        project = Project(folder / "work", environment, [*targets, *make_options(arguments)], arguments.stubs)
        project.folder.mkdir()
        store = "results/.store"
        if arguments.fault in ("disk", "readonly"):
            stack.enter_context(small_disk(project.folder / "disk"))
            (project.folder / "results").mkdir()
            (project.folder / "disk/store").mkdir()
            (project.folder / "results/.store").symlink_to(project.folder / "disk/store")
        project.prepare(arguments.sequences, store, kept / store / "kernels")
        started = time.monotonic()
        try:
            run_with_fault(arguments, slurm, project)
        finally:
            report(slurm, project, time.monotonic() - started)
        compare(local, project, arguments.target)


if __name__ == "__main__":
    sys.exit(main())
