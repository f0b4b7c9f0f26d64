"""Give the project's own workflow every bad input of the tests' tables, and see how each is refused.

    python benchmarks/refusals.py

Each must end within ten seconds with a status other than 0 and one sentence, the one of the table; nothing may be
written, and the results of an earlier run must stay as they were.
"""

from __future__ import annotations

import argparse
import importlib
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import yaml

ROOT = Path(__file__).resolve().parents[1]
LONGEST = 10.0
SMALL = {"frames": {"min_frames": 8}}
COMMANDS = {
    "cores": (["--cores", "-3"], "--cores: expected a whole number of at least 1, got -3."),
    "value in brackets": (["--config", "depth={iterations: many}"], "depth.iterations: expected integer"),
    "absent video": (["--config", "video=nowhere.mp4"], "video: expected a video file or a folder of photos"),
    "store that is a file": (["--config", "store=Snakefile"], "store: expected a folder to write to, found a file"),
    "store below a file": (["--config", "store=Snakefile/a"], "store: expected a folder to write to, found a file"),
    "store that cannot be": (["--config", "store=/proc/store"], "store: expected"),
}


def main() -> int:
    """Print a line for each bad input that is not refused as it should be, and figures; return 1 if there is any."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--only", default="", metavar="WORD", help="those in whose names this is")
    arguments = parser.parse_args()
    sys.path[:0] = [str(ROOT / "tests/inputs"), str(ROOT / "tests/workflow")]
    times, busy, faults = {}, {}, []
    with tempfile.TemporaryDirectory(prefix="threedfs-refusals-") as folder:
        home = Path(folder) / "home"
        _make_home(home)
        for name, words, sentence in _list_cases(Path(folder), home):
            if arguments.only not in name:
                continue
            before = _look_at(home)
            started, worked = time.monotonic(), _seconds_of_children()
            status, said = _run(home, words)
            times[name], busy[name] = time.monotonic() - started, _seconds_of_children() - worked
            found = [*_judge(status, said, sentence), *_compare(before, _look_at(home))]
            if times[name] > LONGEST:
                found.append(f"took {times[name]:.1f} s, {busy[name]:.1f} s of core")
            faults += [name] if found else []
            print(f"{name}: {'; '.join(found) or 'refused'}", flush=True)
            if any(fault.startswith(("made", "changed")) for fault in found):
                _make_home(home)
    print(f"{len(times)} bad inputs, {len(faults)} of them not refused as they should be")
    for what, seconds in (("seconds", times), ("seconds of core", busy)):
        print(f"{what}: {sum(seconds.values()) / len(seconds):.1f} on average, at most {max(seconds.values()):.1f}")
    return 1 if faults else 0


def _seconds_of_children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _make_home(home: Path) -> None:
    """Make a folder to run in, with results of an earlier run; configurations of the tests name its files."""
    shutil.rmtree(home, ignore_errors=True)
    earlier = ["results/earlier/11_object/surface/mesh.ply", "results/metrics.csv", "results/index.html"]
    for name in (*earlier, "results/.store/objects/00/earlier", "config/file", "Snakefile"):
        path = home / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(name)


def _list_cases(folder: Path, home: Path) -> Iterator[tuple[str, list[str], str]]:
    """Yield the name of each bad input, the words of the command line, and the sentence, having written its files."""
    configurations = importlib.import_module("test_bad_configuration").CASES
    refused = importlib.import_module("test_refusals").CASES
    for kind, cases in (("configuration", configurations), ("run", refused)):
        for name, (text, sentence) in cases.items():
            (home / "case.yaml").write_text(f"{text}\n")
            yield f"{kind}, {name}", ["--configfile", "case.yaml"], sentence
    for name, (words, sentence) in COMMANDS.items():
        yield f"command line, {name}", words, sentence
    files, sound = importlib.import_module("test_bad_files"), folder / "sound"
    sound.mkdir()
    importlib.import_module("specimens").write_sound(sound)
    future = sound / "future.mp4"
    shutil.copy(sound / "video.mp4", future)
    os.utime(future, (4e9, 4e9))
    spoilt = {("source", "of the future"): (lambda place, sound: future, "expected a file of the past")}
    spoilt |= {("cameras", name): case for name, case in files.CAMERAS.items()}
    # the check of the configuration sees it first
    spoilt["cameras", "absent"] = (files.CAMERAS["absent"][0], "cameras: expected a file or folder, found no")
    spoilt |= {("truth_mesh", name): case for name, case in files.MESHES.items()} | files.SEQUENCES
    for number, ((key, name), (make, sentence)) in enumerate(spoilt.items()):
        place = folder / f"given{number}"
        place.mkdir()
        path = make(place, sound)
        if (key, path.suffix) in (("cameras", ".bin"), ("cameras", ".txt")):
            path = path.parent
        entry = {key: str(path)} if key == "source" else _describe(sound) | {key: str(path)}
        (home / "case.yaml").write_text(yaml.safe_dump({**SMALL, "sequences": {"a": _nest(entry)}}))
        yield f"{key}, {name}", ["--configfile", "case.yaml"], sentence


def _describe(sound: Path) -> dict[str, str]:
    """Return the files of a sound sequence."""
    truth = {"masks": "masks", "cameras": "cameras.json", "mesh": "mesh.ply", "depth": "depth"}
    given = {"source": "video.mp4", "cameras": "cameras.json", **{f"truth_{key}": name for key, name in truth.items()}}
    return {key: str(sound / name) for key, name in given.items()}


def _nest(entry: dict[str, str]) -> dict:
    """Lay out the files of a sequence as a configuration has them."""
    truth = {key.removeprefix("truth_"): path for key, path in entry.items() if key.startswith("truth_")}
    return {key: path for key, path in entry.items() if not key.startswith("truth_")} | (
        {"truth": truth} if truth else {}
    )


def _run(home: Path, words: list[str]) -> tuple[int, str]:
    program = [sys.executable, "-m", "snakemake", "--snakefile", str(ROOT / "Snakefile")]
    words = words if "--cores" in words else ["--cores", "1", *words]
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "src")}
    done = subprocess.run(
        [*program, *words],
        cwd=home,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    return done.returncode, done.stdout


def _judge(status: int, said: str, sentence: str) -> list[str]:
    """Return what is wrong with how a run ended."""
    lines = [line for line in said.splitlines() if line.startswith("threedfs: ")]
    faults = [] if status else ["ended with status 0"]
    faults += ["a traceback"] if "Traceback" in said else []
    faults += [] if len(lines) == 1 else [f"{len(lines)} sentences"]
    return faults + ([] if any(sentence in line for line in lines) else [f"said {lines or said[-300:]}"])


def _look_at(home: Path) -> dict[str, tuple[int, bytes]]:
    """Return the files of a folder with time and content, without Snakemake's own."""
    files = (path for path in home.rglob("*") if path.is_file() and ".snakemake" not in path.parts)
    return {path.relative_to(home).as_posix(): (path.stat().st_mtime_ns, path.read_bytes()) for path in files}


def _compare(before: dict, after: dict) -> list[str]:
    """Return what a run has made, changed or removed."""
    made, gone = sorted(after.keys() - before), sorted(before.keys() - after)
    changed = sorted(name for name in before.keys() & after if before[name] != after[name])
    return [f"{what} {', '.join(names)}" for what, names in (("made", made), ("changed", changed + gone)) if names]


if __name__ == "__main__":
    sys.exit(main())
