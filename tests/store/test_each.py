"""Property: of a chain of stages over all keyframes, only what the store has not is done, whatever ends the job."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import time
from pathlib import Path

import pytest

from threedfs.store.command import run_keyframes

STAGES = {
    "trace": '''"""A stage on one keyframe."""

import os, time
from pathlib import Path

from threedfs.errors import UserError


def run(*, keyframes: Path, photos: Path, lines: Path, keyframe: str, job):
    """Write the keyframe's photo."""
    job.progress.note("traced")
    lines.write_text((photos / keyframe).read_text())
''',
    "fill": '''"""A stage that reads what the one before it made, and what all keyframes have."""

from pathlib import Path


def run(*, keyframes: Path, lines: Path, plans: list[Path], area: Path, keyframe: str, colour: str, job):
    """Write the lines and all plans."""
    job.progress.note(f"filled by {job.threads}")
    area.write_text(colour + lines.read_text() + "+".join(path.read_text() for path in plans))
''',
}
NAMES = ["000010", "000002", "photo-b", "photo"]
"""In an order of their own."""
PROGRAM = """
import sys
from pathlib import Path
sys.path.insert(0, {tests!r})
from test_each import work
work(Path({folder!r}), {threads})
print(*sorted(name for name in sys.modules if name.startswith("toolbox.stages.") or name == "numpy"))
"""


def work(folder: Path, threads: int = 1, colour: str = "red", **options) -> str:
    """Do the chain on a folder's keyframes; return the log."""
    log = folder / "logs/draw.log"
    run_keyframes(
        "draw",
        ["trace", "fill"],
        {
            name: folder / place
            for name, place in (("keyframes", "keyframes.json"), ("photos", "photos"), ("plans", "plans"))
        },
        {"lines": folder / "lines", "area": folder / "area"},
        {"trace": {}, "fill": {}},
        {"sequence": "mug"},
        {"colour": colour},
        store=folder / "store",
        log=log,
        threads=threads,
        seed=0,
        package="toolbox",
        **options,
    )
    return log.read_text()


@pytest.fixture
def folder(toolbox, tmp_path):
    """What the chain reads: photos, which are a folder to their stage, and a file of each keyframe."""
    for name, text in STAGES.items():
        (toolbox / "stages" / f"{name}.py").write_text(text)
    for place in ("photos", "plans"):
        (tmp_path / place).mkdir()
    for name in NAMES:
        (tmp_path / "photos" / name).write_text(f"<{name}>")
        (tmp_path / f"plans/{name}.zarr.zip").write_text(f"({name})")
    entries = {name: {} for name in NAMES}
    document = {"schema": "threedfs/keyframes/1", "order": NAMES, "keyframes": entries}
    (tmp_path / "keyframes.json").write_text(json.dumps(document))
    return tmp_path


@pytest.fixture
def edit(toolbox):
    """Put a statement at the start of a stage's `run`; its code then counts as another one."""

    def insert(stage: str, statement: str) -> None:
        path = toolbox / "stages" / f"{stage}.py"
        path.write_text(STAGES[stage].replace("    job.progress", f"    {statement}\n    job.progress"))

    return insert


def made(folder: Path) -> dict[str, str]:
    """Return what the chain made, by relative path."""
    files = (file for place in ("lines", "area") for file in (folder / place).iterdir())
    return {file.relative_to(folder).as_posix(): file.read_text() for file in files}


def notes(log: str) -> list[str]:
    """Return the notes of stages in a log, sorted."""
    return sorted(re.findall(r"^\w+ of mug (\S+: (?:traced|filled))", log, re.MULTILINE))


def run_apart(folder: Path, spawn, threads: int) -> subprocess.Popen:
    """Do the chain in a process of its own."""
    return spawn(PROGRAM.format(tests=str(Path(__file__).parent), folder=str(folder), threads=threads))


def is_alive(process):
    try:
        return ") Z " not in Path(f"/proc/{process}/stat").read_text()
    except (FileNotFoundError, ProcessLookupError):  # the latter if it goes while its file is open
        return False


def wait_for(condition, process):
    """Wait until a condition holds while a process runs."""
    end = time.monotonic() + 60
    while not condition():
        assert process.poll() is None and time.monotonic() < end
        time.sleep(0.01)


def test_every_stage_gets_its_own_inputs_of_every_keyframe(folder):
    log = work(folder)
    plans = "+".join(f"({name})" for name in NAMES)
    expected = {f"lines/{name}.zarr.zip": f"<{name}>" for name in NAMES}
    assert made(folder) == expected | {f"area/{name}.zarr.zip": f"red<{name}>{plans}" for name in NAMES}
    assert re.findall(r"^draw of mug (\S+): done in .* s (.*)$", log, re.MULTILINE) == [
        (name, f"({number}/4)") for number, name in enumerate(NAMES, start=1)
    ]
    ends = log.splitlines()[-8:]
    assert len(set(ends)) == 8 and all(line.startswith("action ") for line in ends)
    assert log.count("filled by 1") == 4


def test_second_time_all_is_taken_and_no_stage_imported(folder, spawn):
    first = work(folder).splitlines()[-8:]
    (folder / "lines/000002.zarr.zip").unlink()
    (folder / "area/stale.zarr.zip").write_text("of a keyframe that is none now")
    before = made(folder)
    process = run_apart(folder, spawn, 2)
    assert process.communicate()[0].split() == [] and process.returncode == 0
    log = (folder / "logs/draw.log").read_text()
    assert log.splitlines()[-8:] == first and log.count(": taken from the store in") == 4 and not notes(log)
    assert set(made(folder)) == set(before) - {"area/stale.zarr.zip"} | {"lines/000002.zarr.zip"}


def test_setting_of_the_second_stage_leaves_the_first(folder):
    work(folder)
    assert notes(work(folder, colour="blue")) == sorted(f"{name}: filled" for name in NAMES)
    assert made(folder)["area/photo.zarr.zip"].startswith("blue")
    assert not notes(work(folder))


def test_number_of_workers_changes_no_byte(folder, tmp_path):
    keys = []
    for threads in (1, 2, 9):
        log = work(folder, threads)
        keys.append((log.splitlines()[-8:], made(folder)))
        assert len(notes(log)) == 8
        (folder / "store").rename(folder / f"store{threads}")
    assert keys[0] == keys[1] == keys[2]


def test_chosen_keyframes_only(folder):
    work(folder, keyframes=["photo"])
    assert set(made(folder)) == {"lines/photo.zarr.zip", "area/photo.zarr.zip"}
    assert work(folder, keyframes=[]).splitlines() == ["action none"] and not made(folder)


def test_killed_job_goes_on_where_it_was_and_leaves_no_worker(folder, edit, spawn):
    edit("trace", "(Path(photos).parent / f'at-{keyframe}').write_text(str(os.getpid()))")
    trace = folder / "src/toolbox/stages/trace.py"
    trace.write_text(
        trace.read_text() + "    time.sleep(60 * (keyframe == 'photo-b' and (photos.parent / 'slow').exists()))\n"
    )
    (folder / "slow").touch()
    process = run_apart(folder, spawn, 1)
    wait_for(lambda: (folder / "at-photo-b").is_file() and (folder / "at-photo-b").read_text(), process)
    os.kill(process.pid, signal.SIGKILL)
    process.communicate()
    worker = int((folder / "at-photo-b").read_text())
    end = time.monotonic() + 20
    while is_alive(worker):
        assert time.monotonic() < end, "the worker outlived the job"
        time.sleep(0.01)
    (folder / "slow").unlink()
    log = work(folder, 2)
    assert notes(log) == sorted(f"{name}: {what}" for name in NAMES[2:] for what in ("traced", "filled"))
    assert len(made(folder)) == 8


@pytest.mark.parametrize("threads", [1, 2])
def test_a_refused_keyframe_is_told_once_and_the_others_are_kept(folder, edit, capsys, threads):
    edit("fill", "if keyframe[0] == '0': from threedfs.errors import UserError; raise UserError('no zeros.')")
    with pytest.raises(SystemExit) as ended:
        work(folder, threads)
    assert ended.value.code == 1
    log = (folder / "logs/draw.log").read_text()
    assert log.splitlines()[-1] == "threedfs: fill of mug 000010 and 1 more: no zeros."
    assert log.count("no zeros.") == 1 and capsys.readouterr().err.count("no zeros.") == 1
    assert log.count("\naction ") == 6 and "Traceback" not in log
    assert {name for name in made(folder) if name.startswith("area")} == {
        "area/photo.zarr.zip",
        "area/photo-b.zarr.zip",
    }
    with pytest.raises(SystemExit):
        work(folder, threads)
    assert notes((folder / "logs/draw.log").read_text()) == []


def test_fault_of_the_program_leaves_its_traceback_in_the_log(folder, edit):
    edit("fill", "if keyframe == '000002': raise ZeroDivisionError('by nothing')")
    with pytest.raises(SystemExit):
        work(folder)
    log = (folder / "logs/draw.log").read_text()
    assert "fill of mug 000002:\nTraceback" in log
    assert log.splitlines()[-1] == "ZeroDivisionError: by nothing"
    assert "area/000010.zarr.zip" in made(folder)


@pytest.mark.parametrize("threads", [1, 2])
def test_a_killed_worker_is_told_in_a_sentence(folder, edit, threads):
    edit("trace", "keyframe == '000002' and os.kill(os.getpid(), 9)")
    with pytest.raises(SystemExit):
        work(folder, threads)
    log = (folder / "logs/draw.log").read_text()
    assert log.splitlines()[-1].startswith(
        "threedfs: draw of mug 000002: the process that worked on it was killed by signal 9, as when memory runs out"
    )
    others = set(NAMES) - {"000002"} if threads == 2 else {"000010"}
    assert {name for name in made(folder) if name.startswith("area")} == {f"area/{name}.zarr.zip" for name in others}


def test_interrupt_ends_the_workers(folder, edit, spawn):
    edit("trace", "(Path(photos).parent / f'at-{keyframe}').write_text(str(os.getpid())); time.sleep(60)")
    at = [folder / f"at-{name}" for name in NAMES[:2]]
    process = run_apart(folder, spawn, 2)
    # there is a file before its number is written
    wait_for(lambda: all(path.is_file() and path.stat().st_size for path in at), process)
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=20)
    assert process.returncode != 0
    for path in at:
        assert not Path(f"/proc/{path.read_text()}").is_dir()
