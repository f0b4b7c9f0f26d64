"""Damage what a run has left, and see that nothing wrong is believed: all is named, and made again by who needs it.

    python benchmarks/damage.py
    python benchmarks/damage.py --real

First a bit of every record of the store flips, and one of each of ten files of results (nine by stand-ins); what the
last stages made is deleted, so that they are done again and read those files. Then a bit of every record and kernel
and of twenty objects flips, five objects are cut, five become folders, links and pipes, and all results are deleted.
Each time all damage must be named, and the results of the run that follows must have the bytes of before.
"""

from __future__ import annotations

import argparse
import importlib
import os
import random
import shutil
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path

from kills import ROOT, compare, make_project, make_real_project

from threedfs.store.audit import Audit, audit_results, audit_store

LAST = ("07_fusion", "11_object", "12_evaluate", "../tables")  # folders of a sequence
READ = (  # by the jobs that fill those
    "01_frames/[!.]*",
    "02_poses/poses.json",
    "03_keyframes/[!.]*",
    "03_scene/support.json",
    "04_crops/keyframes.json",
    "04_semidense/[!.]*",
    "06_depth/[!.]*",
)
BECOME = ("folder", "empty folder", "link", "dangling link", "pipe")


def main() -> int:
    """Print what was damaged, named and made again; return 1 if anything is not as it should be."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--real", action="store_true", help="the real stages")
    arguments = parser.parse_args()
    sys.path.insert(0, str(ROOT / "tests/store"))
    replace = importlib.import_module("test_damage").replace
    draw = random.Random(arguments.seed)
    with tempfile.TemporaryDirectory(prefix="threedfs-damage-") as folder:
        project = (make_real_project if arguments.real else make_project)(Path(folder) / "project")
        project.run()
        right, results = project.artifacts(), project.folder / "results"
        print(f"a run makes {len(right)} files", flush=True)

        records = sorted((results / ".store/actions").rglob("*.json"))
        for name in LAST:
            shutil.rmtree(results / "sample" / name)
        read = sorted(path for name in READ for path in (results / "sample").glob(name))
        read = draw.sample(read, min(len(read), 10))
        _flip([*records, *read], draw)
        print(f"flipped: {len(records)} records, {len(read)} files of results")
        faults = [*_check_named([*records, *read], results), *_run_again(project, right)]

        objects = sorted(path for path in (results / ".store/objects").rglob("*") if path.is_file())
        chosen = draw.sample(objects, min(len(objects), 30))
        kernels = sorted((results / ".store/kernels").rglob("*.kernel"))
        _flip([*records, *kernels, *chosen[10:]], draw)
        for path in chosen[:5]:
            _write(path, path.read_bytes()[:-1])
        for path, kind in zip(chosen[5:10], BECOME, strict=True):
            replace(path, kind, project.folder)
        print(
            f"flipped: {len(records)} records, {len(kernels)} kernels, {len(chosen[10:])} objects; cut: 5; no files: 5"
        )
        faults += _check_named([*records, *kernels, *chosen], results)
        for path in results.iterdir():
            if path.name != ".store":
                shutil.rmtree(path) if path.is_dir() else path.unlink()
        faults += _run_again(project, right)
        left = audit_store(results / ".store").damage
        print(f"of all damage {len(left)} are left")
        faults += left
    print(*faults, f"faults: {len(faults)}", sep="\n")
    return 1 if faults else 0


def _flip(paths: Iterable[Path], draw: random.Random) -> None:
    """Flip a bit of each file, and leave its time as it was."""
    for path in paths:
        data = bytearray(path.read_bytes())
        data[draw.randrange(len(data))] ^= 1 << draw.randrange(8)
        _write(path, bytes(data))


def _write(path: Path, content: bytes) -> None:
    status = path.stat()
    path.chmod(status.st_mode | 0o200)
    path.write_bytes(content)
    path.chmod(status.st_mode)
    os.utime(path, ns=(status.st_atime_ns, status.st_mtime_ns))


def _check_named(paths: Iterable[Path], results: Path) -> list[str]:
    """Return those that `threedfs store verify --results` does not name."""
    audit: Audit = audit_store(results / ".store")
    audit_results(results, audit)
    print(f"{len(audit.damage)} are named")
    return [f"{path} is not named" for path in paths if not any(str(path) in said for said in audit.damage)]


def _run_again(project, right: dict[str, bytes]) -> list[str]:
    """Run, and return what is not as it was."""
    said = project.run()
    healed = said.count("it is taken from the store again")
    print(f"{said.count(': done in ')} computed, {healed} results taken from the store again", flush=True)
    return [f"{name} differs" for name in compare(project.artifacts(), right)]


if __name__ == "__main__":
    sys.exit(main())
