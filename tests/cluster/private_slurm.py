"""A Slurm of its own on this machine: two nodes, in a folder, stopped when it is left."""

from __future__ import annotations

import getpass
import os
import secrets
import shutil
import signal
import socket
import subprocess
import time
from pathlib import Path

PROGRAMS = ("munged", "slurmctld", "slurmd", "srun", "sbatch", "squeue", "scancel", "scontrol")
NODES = ("n1", "n2")

_CONFIGURATION = """\
ClusterName=private
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmUser={user}
SlurmdUser={user}
AuthInfo=socket={folder}/munge.socket
StateSaveLocation={folder}/state
SlurmctldPidFile={folder}/slurmctld.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdPidFile={folder}/%n.pid
SlurmdLogFile={folder}/%n.log
SlurmdSpoolDir={folder}/%n
MpiDefault=none
SwitchType=switch/none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SchedulerParameters=sched_min_interval=0,batch_sched_delay=0
JobAcctGatherType=jobacct_gather/linux
JobAcctGatherFrequency=task=1
JobAcctGatherParams=OverMemoryKill
JobCompType=jobcomp/filetxt
JobCompLoc={folder}/completed
SlurmdParameters=config_overrides
SlurmdTimeout=10
KillWait=2
MinJobAge=300
ReturnToService=2
NodeName=n1 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[1]} CPUs=2 RealMemory={memory}
NodeName=n2 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[2]} CPUs=2 RealMemory={memory}
PartitionName=main Nodes=ALL Default=YES State=UP
"""

_SRUN = """\
#!/bin/sh
SLURM_CONF={folder}/slurm.conf exec {srun} "$@"
"""


def find_missing() -> list[str]:
    """Return the programs of Slurm and munge that are not installed."""
    return [name for name in PROGRAMS if shutil.which(name, path=_search_path()) is None]


def install() -> None:
    """Install Debian's Slurm and munge, as root."""
    environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    for words in (["update"], ["install", "--yes", "--no-install-recommends", "slurm-wlm", "munge"]):
        subprocess.run(["apt-get", "-qq", *words], env=environment, check=True)


def can_install() -> bool:
    """Say whether `install` may work."""
    return os.geteuid() == 0 and shutil.which("apt-get") is not None


class PrivateSlurm:
    """Slurm and munge with keys, ports, spool and logs of their own; a context.

    Jobs over their memory are killed by Slurm's own accounting, which looks every second: no cgroup of the machine
    is touched.

    Parameters
    ----------
    folder : Path
        Gets everything; its path must be short, as it holds a socket.
    memory : int
        Of a node, MB.
    """

    def __init__(self, folder: Path, memory: int = 8000) -> None:
        self.folder = folder
        self.memory = memory
        path = f"{folder / 'bin'}:{_search_path()}"
        self.environment = {**os.environ, "PATH": path, "SLURM_CONF": str(folder / "slurm.conf")}
        self._daemons: dict[str, subprocess.Popen] = {}

    def __enter__(self) -> PrivateSlurm:
        self.folder.mkdir(parents=True, mode=0o755)
        for name in ("bin", "state", *NODES):
            (self.folder / name).mkdir()
        # Snakemake's plugin takes SLURM_CONF out of the environment of the srun that it calls within a job
        srun = self.folder / "bin/srun"
        srun.write_text(_SRUN.format(folder=self.folder, srun=shutil.which("srun", path=_search_path())))
        srun.chmod(0o755)
        key = self.folder / "munge.key"
        key.write_bytes(secrets.token_bytes(1024))
        key.chmod(0o400)
        text = _CONFIGURATION.format(
            folder=self.folder,
            host=socket.gethostname().partition(".")[0],
            user=getpass.getuser(),
            ports=_find_ports(3),
            memory=self.memory,
        )
        (self.folder / "slurm.conf").write_text(text)
        try:
            self._start()
        except BaseException:
            self.stop()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def _start(self) -> None:
        files = [f"--{what}-file={self.folder}/munge.{what}" for what in ("key", "pid", "log", "seed")]
        self._launch("munged", "--foreground", "--force", f"--socket={self.folder}/munge.socket", *files)
        _wait_for(lambda: (self.folder / "munge.socket").exists(), "munged has made its socket", self.folder)
        self._launch("slurmctld", "-D", "-c")
        for node in NODES:
            self.start_node(node)
        _wait_for(lambda: self.query("sinfo", "-h", "-o", "%D %T") == "2 idle", "two nodes are idle", self.folder)

    def _launch(self, name: str, *words: str) -> None:
        with open(self.folder / f"{name}.out", "ab") as output:
            self._daemons[name] = subprocess.Popen(
                [words[0] if name in NODES else name, *(words[1:] if name in NODES else words)],
                env=self.environment,
                stdout=output,
                stderr=output,
                start_new_session=True,  # so that Ctrl-C reaches us only, and we end them
            )

    def start_node(self, node: str) -> None:
        """Start a node's daemon."""
        self._launch(node, "slurmd", "-D", "-N", node)

    def kill_node(self, node: str) -> None:
        """Kill a node's daemon and what runs on it, as when its power fails."""
        victims = [self._daemons[node].pid, *self._steps_of(node)]
        victims += [child for step in victims[1:] for child in _descendants(step)]
        for process in victims:
            _kill(process)
        self._daemons[node].wait()

    def query(self, *words: str) -> str:
        """Return what a command of Slurm prints."""
        done = subprocess.run(words, env=self.environment, capture_output=True, text=True, check=False)
        return done.stdout.strip()

    def completed(self) -> list[str]:
        """Return the lines of Slurm's log of jobs that have ended."""
        log = self.folder / "completed"
        return log.read_text().splitlines() if log.exists() else []

    def stop(self) -> None:
        """End the jobs, then every daemon that was started here, by its process id."""
        if "slurmctld" in self._daemons and self._daemons["slurmctld"].poll() is None:
            self.query("scancel", "--user", getpass.getuser())
            end = time.monotonic() + 10
            while self.query("squeue", "-h", "-t", "R,CG") and time.monotonic() < end:
                time.sleep(0.2)
        for node in NODES:
            for step in self._steps_of(node):
                for process in (step, *_descendants(step)):
                    _kill(process)
        for daemon in reversed(self._daemons.values()):
            if daemon.poll() is None:
                daemon.terminate()
                try:
                    daemon.wait(10)
                except subprocess.TimeoutExpired:
                    daemon.kill()
                    daemon.wait()
        self._daemons.clear()

    def _steps_of(self, node: str) -> list[int]:
        """Return the processes that hold a node's jobs: slurmstepd keeps the node's spool folder in its environment."""
        marks = (f"SLURM_CONF={self.folder}/slurm.conf".encode(), f"SLURMD_NODENAME={node}".encode())
        found = []
        for entry in Path("/proc").iterdir():
            if entry.name.isdigit():
                try:
                    if not (entry / "comm").read_text().startswith("slurmstepd"):
                        continue
                    children = [Path("/proc", str(child), "environ") for child in _descendants(int(entry.name))]
                    if any(set(marks) <= set(child.read_bytes().split(b"\0")) for child in children):
                        found.append(int(entry.name))
                except OSError:
                    continue  # it has ended meanwhile
        return found


def _search_path() -> str:
    return f"{os.environ['PATH']}:/usr/sbin:/sbin"


def _find_ports(count: int) -> list[int]:
    """Return free ports."""
    sockets = [socket.socket() for _ in range(count)]
    try:
        for one in sockets:
            one.bind(("127.0.0.1", 0))
        return [one.getsockname()[1] for one in sockets]
    finally:
        for one in sockets:
            one.close()


def _wait_for(true, what: str, folder: Path, seconds: float = 30) -> None:
    end = time.monotonic() + seconds
    while not true():
        if time.monotonic() > end:
            raise RuntimeError(f"expected that {what} within {seconds:.0f} s, but it did not come; see {folder}/*.log")
        time.sleep(0.2)


def _descendants(process: int) -> list[int]:
    """Return the processes below one."""
    try:
        tasks = [*Path(f"/proc/{process}/task").iterdir()]
        below = [int(child) for task in tasks for child in (task / "children").read_text().split()]
    except OSError:
        return []
    return [*below, *(deeper for child in below for deeper in _descendants(child))]


def _kill(process: int) -> None:
    try:
        os.kill(process, signal.SIGKILL)
    except ProcessLookupError:
        pass
