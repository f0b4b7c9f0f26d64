"""Two runs at once, of two checkouts that share one store, on the same sequences: is any work done twice?

    python benchmarks/two_heads.py --sequences 3

Each checkout is a clone of this one's last commit. The stages are the real ones, in the quick preset; the sequences are
the sample, a frame apart. Every action that a job begins to compute has a folder in the store's scratch space; Linux
tells of each as it is made, so none is missed, and work that came to nothing counts too. At the end the store is
verified, and results of the two are compared byte by byte.
"""

from __future__ import annotations

import argparse
import ctypes
import os
import re
import struct
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from kills import ROOT, compare, load_stand_ins

from threedfs.store.audit import audit_results, audit_store
from threedfs.store.records import read_record

SEQUENCES = """\
dataset: heads
methods: [fused_sdf, gc_2d3d_pixel, surface]
store: {store}
sequences:
"""
SEQUENCE = """\
  s{number}:
    source: {sample}/video.mp4
    cameras: {sample}/cameras.json
    truth: {{masks: {sample}/masks, cameras: {sample}/cameras.json, mesh: {sample}/mesh.ply}}
    settings: {{frames: {{max_frames: {frames}}}}}
"""
_CREATED, _LOST = 0x100, 0x4000  # IN_CREATE and IN_Q_OVERFLOW of inotify
_HEADER = struct.Struct("iIII")  # which watch, what happened, cookie, length of the name
_WORK = re.compile(r"\.([0-9a-f]{64})\..*\.part")


class NewFolders:
    """Tells the names of all that is made in a folder, as Linux's inotify has them."""

    def __init__(self, folder: Path) -> None:
        library = ctypes.CDLL(None, use_errno=True)
        self._descriptor = library.inotify_init1(os.O_NONBLOCK | os.O_CLOEXEC)
        if self._descriptor < 0 or library.inotify_add_watch(self._descriptor, os.fsencode(folder), _CREATED) < 0:
            raise OSError(ctypes.get_errno(), "expected that this system watches folders (Linux)", str(folder))

    def read(self) -> list[str]:
        """Return the names since the last call."""
        names = []
        while True:
            try:
                told = os.read(self._descriptor, 1 << 16)
            except BlockingIOError:
                return names
            while told:
                _, happened, _, length = _HEADER.unpack_from(told)
                if happened & _LOST:
                    raise OSError("expected to be told of every new folder, but Linux has left some out; wait less")
                names.append(os.fsdecode(told[_HEADER.size : _HEADER.size + length].rstrip(b"\0")))
                told = told[_HEADER.size + length :]


def main() -> int:
    """Print figures and faults; return 1 if there were any."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--sequences", type=int, default=3)
    parser.add_argument("--cores", type=int, default=1, help="of each run (1)")
    parser.add_argument("--delay", type=float, default=0.0, help="seconds until the second run is started")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="threedfs-heads-") as name:
        folder, store = Path(name), Path(name) / "store"
        (store / "scratch").mkdir(parents=True)
        heads = [_make_checkout(folder / head, store, arguments.sequences) for head in ("first", "second")]
        started = time.monotonic()
        begun, ended = _run_all(heads, NewFolders(store / "scratch"), arguments.cores, arguments.delay)
        seconds = time.monotonic() - started
        faults = [f"{head.folder.name} ended with status {end}" for head, end in zip(heads, ended, strict=True) if end]
        faults += [f"action {key} was begun {count} times" for key, count in begun.items() if count > 1]
        first, second = (head.artifacts() for head in heads)
        faults += [f"{name} differs" for name in compare(first, second)]
        audit = audit_store(store)
        for head in heads:
            audit_results(head.folder / "results", audit)
        faults += audit.damage
        _print_figures(heads, store, begun, audit, seconds, len(first))
    print(*faults, f"faults: {len(faults)}", sep="\n")
    return 1 if faults else 0


def _run_all(heads, new: NewFolders, cores: int, delay: float) -> tuple[Counter, list[int]]:
    """Run heads side by side; return how often each action was begun, and their exit statuses."""
    running, begun = [], Counter()
    try:
        for head in heads:
            running.append(_start(head, cores))
            if len(running) < len(heads):
                time.sleep(delay)
        while any(run.poll() is None for run in running):
            begun.update(_actions(new))
            time.sleep(0.1)
        begun.update(_actions(new))
    finally:
        for run in running:
            if run.poll() is None:
                run.terminate()
                run.wait()
    return begun, [run.returncode for run in running]


def _make_checkout(folder: Path, store: Path, sequences: int):
    """Clone this checkout; return the clone, as the workflow's tests have a project."""
    subprocess.run(["git", "clone", "--quiet", str(ROOT), str(folder)], check=True)
    text = SEQUENCES.format(store=store)
    for number in range(sequences):
        text += SEQUENCE.format(number=number, sample=ROOT / "resources/sample", frames=24 - number)
    (folder / "sequences.yaml").write_text(text)
    return load_stand_ins().Project(folder)


def _start(head, cores: int) -> subprocess.Popen:
    with open(head.folder / "run.log", "wb") as log:
        return subprocess.Popen(
            [head.command[0], "--cores", str(cores), "--configfile", "sequences.yaml", "config/presets/quick.yaml"],
            cwd=head.folder,
            env=head.forking,
            stdout=log,
            stderr=log,
        )


def _actions(new: NewFolders) -> list[str]:
    """Return the keys of the actions that were begun since the last call."""
    return [found[1] for found in map(_WORK.fullmatch, new.read()) if found]


def _print_figures(heads, store: Path, begun: Counter, audit, seconds: float, files: int) -> None:
    for head in heads:
        log = (head.folder / "run.log").read_text()
        done, taken = log.count(": done in "), log.count(": taken from the store")
        waited = len(re.findall(r"waits for .* which does the same work", log))
        print(f"{head.folder.name}: {done} jobs and keyframes done, {taken} taken from the store, {waited} waited for")
    times = Counter(begun.values())
    for count, actions in sorted(times.items()):
        print(f"{actions} actions computed {count} times")
    for key in (key for key, count in begun.items() if count > 1):
        record = read_record(store, key)
        print(f"more than once: {record['stage'] if record else key}, {record['seconds'] if record else '?'} s")
    print(f"{audit.objects} objects, {audit.records} records, {audit.kernels} kernels, {len(audit.damage)} damaged")
    print(f"{files} files in the results of each, {seconds:.0f} s")


if __name__ == "__main__":
    sys.exit(main())
