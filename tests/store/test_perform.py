"""Property: the same work is done once, whatever happens to results, store, processes and clocks."""

from __future__ import annotations

import io
import json
import os
import signal
import socket
import stat
import time
from pathlib import Path

import pytest

from threedfs.errors import UserError
from threedfs.progress import Progress
from threedfs.store.action import Task
from threedfs.store.perform import perform

PROGRAM = """
import io
from pathlib import Path
from threedfs.progress import Progress
from threedfs.store.action import Task
from threedfs.store.perform import perform
folder = Path({folder!r})
task = Task("join", {{"parts": folder / "a"}}, {{"whole": folder / {name!r}}}, package="toolbox")
print(perform(task, folder / "store", progress=Progress("join", io.StringIO())).hit)
assert {numpy} or "numpy" not in __import__("sys").modules
"""


@pytest.fixture
def join(toolbox, tmp_path):
    """Perform the stage on given inputs; files are made from their text."""

    def work(parts, name="whole", wildcards=None, seed=0, threads=1, log=None):
        outputs, wildcards = {"whole": tmp_path / name}, wildcards or {}
        task = Task("join", {"parts": parts}, outputs, wildcards=wildcards, seed=seed, package="toolbox")
        progress = Progress("join", log or io.StringIO())
        return perform(task, tmp_path / "store", progress=progress, threads=threads)

    return work


@pytest.fixture
def part(tmp_path) -> Path:
    """A file to read."""
    path = tmp_path / "a"
    path.write_text("one")
    return path


def only_object(store: Path) -> Path:
    """Return the one object of a store."""
    (path,) = (path for path in (store / "objects").rglob("*") if path.is_file())
    return path


def test_second_time_is_a_hit_with_the_same_bytes(join, part, tmp_path):
    assert not join(part).hit
    first = (tmp_path / "whole").read_bytes()
    (tmp_path / "whole").unlink()
    assert join(part).hit
    assert (tmp_path / "whole").read_bytes() == first


def test_hit_imports_neither_stage_nor_numpy(join, part, tmp_path, spawn):
    join(part)
    process = spawn(PROGRAM.format(folder=str(tmp_path), name="again", numpy=False))
    assert process.communicate()[0].split() == ["True"]
    assert process.returncode == 0


def test_place_and_time_of_an_input_do_not_count(join, part, tmp_path):
    join(part)
    moved = tmp_path / "elsewhere" / "b"
    moved.parent.mkdir()
    part.rename(moved)
    os.utime(moved, (1, 1))
    assert join(moved, name="other").hit


@pytest.mark.parametrize("threads", [1, 4])
def test_threads_do_not_count(join, part, threads):
    join(part, threads=2)
    assert join(part, threads=threads).hit


def test_content_wildcards_and_seed_count(join, part):
    keys = {join(part).key, join(part, wildcards={"method": "x"}).key, join(part, seed=1).key}
    part.write_text("two")
    outcome = join(part)
    assert not outcome.hit
    assert len(keys | {outcome.key}) == 4


def test_edit_of_the_same_size_is_seen(join, part, tmp_path):
    join(part)
    part.write_text("eno")
    assert not join(part).hit
    assert (tmp_path / "whole").read_text().startswith("eno")


def test_folders_count_by_names_and_contents(join, tmp_path):
    folder = tmp_path / "photos"
    folder.mkdir()
    (folder / "a").write_text("1")
    (folder / ".hidden").write_text("x")
    key = join(folder).key
    (folder / ".hidden").write_text("y")
    assert join(folder).key == key
    (folder / "a").rename(folder / "b")
    assert join(folder).key != key


def test_lists_count_in_order(join, tmp_path):
    paths = [tmp_path / name for name in "ab"]
    for path in paths:
        path.write_text(path.name)
    assert join(paths).key != join(paths[::-1]).key


def test_absent_input_is_none_and_missing_one_is_refused(join, tmp_path):
    with pytest.raises(UserError, match="expected a file or folder, found none"):
        join(tmp_path / "nothing")
    with pytest.raises(AttributeError):  # the stage is given None, with which it can do nothing
        join(None)


def test_keyframes_count_by_the_entry_that_the_job_is_about(join, tmp_path):
    path = tmp_path / "keyframes.json"

    def write(near, header):
        entries = {"000001": {"near": 1.0}, "000002": {"near": near}}
        path.write_text(json.dumps({"schema": "threedfs/keyframes/1", "keyframes": entries, "provenance": header}))

    write(2.0, "x")
    first = {name: join(path, wildcards={"keyframe": name}).key for name in ("000001", "000002")}
    everything = join(path).key
    write(3.0, "y")
    assert join(path, wildcards={"keyframe": "000001"}).key == first["000001"]
    assert join(path, wildcards={"keyframe": "000002"}).key != first["000002"]
    assert join(path).key != everything


@pytest.mark.parametrize("damage", ["change", "truncate", "remove"])
def test_damaged_object_is_noticed_and_made_anew(join, part, tmp_path, damage):
    join(part)
    whole = (tmp_path / "whole").read_bytes()
    (tmp_path / "whole").unlink()
    damaged = only_object(tmp_path / "store")
    if damage == "remove":
        damaged.unlink()
    else:
        damaged.chmod(0o644)
        damaged.write_bytes(whole[:-1] if damage == "truncate" else b"x" * len(whole))
    log = io.StringIO()
    assert not join(part, log=log).hit
    assert "the work is done again" in log.getvalue()
    assert (tmp_path / "whole").read_bytes() == whole
    assert join(part).hit


def test_damaged_record_is_a_miss(join, part, tmp_path):
    key = join(part).key
    (tmp_path / "store/actions" / key[:2] / f"{key}.json").write_text("{")
    assert not join(part).hit


def test_change_to_a_result_does_not_reach_the_store(join, part, tmp_path):
    join(part)
    whole = (tmp_path / "whole").read_bytes()
    (tmp_path / "whole").write_text("changed by hand")
    assert join(part).hit
    assert (tmp_path / "whole").read_bytes() == whole
    assert not only_object(tmp_path / "store").stat().st_mode & stat.S_IWUSR


def test_record_tells_time_memory_versions_and_outputs(join, part, tmp_path):
    key = join(part).key
    record = json.loads((tmp_path / "store/actions" / key[:2] / f"{key}.json").read_text())
    assert record["stage"] == "join"
    assert record["outputs"]["whole"] == only_object(tmp_path / "store").name
    assert record["bytes"]["whole"] == (tmp_path / "whole").stat().st_size
    assert record["peak_memory_mb"] > 5  # a Python process holds more
    assert 0 <= record["seconds"] < 60
    assert record["versions"]["python"].startswith("3.")
    assert str(tmp_path) not in json.dumps(record)


def test_failed_stage_leaves_nothing(join, tmp_path):
    with pytest.raises(AttributeError):
        join(None)
    assert not (tmp_path / "whole").exists()
    assert not any((tmp_path / "store/scratch").iterdir())
    assert not (tmp_path / "store/actions").exists()


def test_output_folder_comes_back_file_by_file(toolbox, part, tmp_path):
    (toolbox / "stages" / "split.py").write_text(
        "def run(*, parts, masks, job):\n"
        "    (masks / 'deep').mkdir(parents=True)\n"
        "    (masks / 'a.png').write_text('1')\n"
        "    (masks / 'deep' / 'b.png').write_text('2')\n"
    )
    for hit in (False, True):
        (tmp_path / "masks").mkdir()
        (tmp_path / "masks" / "stale.png").write_text("old")
        inputs, outputs = {"parts": part}, {"masks": tmp_path / "masks"}
        task = Task("split", inputs, outputs, package="toolbox")
        outcome = perform(task, tmp_path / "store", progress=Progress("split", io.StringIO()))
        assert outcome.hit is hit
        found = {path.relative_to(tmp_path / "masks").as_posix() for path in (tmp_path / "masks").rglob("*.png")}
        assert found == {"a.png", "deep/b.png"}
        for path in sorted((tmp_path / "masks").rglob("*"), reverse=True):
            path.rmdir() if path.is_dir() else path.unlink()
        (tmp_path / "masks").rmdir()


def test_killed_job_leaves_no_result_and_its_scratch_is_cleared(toolbox, join, part, tmp_path, spawn):
    stage = toolbox / "stages" / "join.py"
    text = stage.read_text()
    stage.write_text(text + "    import time\n    time.sleep(60)\n")
    process = spawn(PROGRAM.format(folder=str(tmp_path), name="whole", numpy=True))
    end = time.monotonic() + 30
    while not list((tmp_path / "store").glob("scratch/.*/whole/whole")):
        assert process.poll() is None and time.monotonic() < end
        time.sleep(0.01)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    assert not (tmp_path / "whole").exists()
    assert any((tmp_path / "store/scratch").iterdir())
    stage.write_text(text)
    assert not join(part).hit
    assert not any((tmp_path / "store/scratch").iterdir())


def test_half_written_copy_of_a_killed_job_is_cleared(join, part, tmp_path, spawn):
    process = spawn("")
    process.communicate()  # its number belongs to nobody now

    stale = tmp_path / f".whole.{socket.gethostname()}.{process.pid}.part"
    stale.write_text("half")
    join(part)
    assert not stale.exists()


def test_jobs_that_make_the_same_object_at_once_all_end_well(join, part, tmp_path, spawn):
    programs = [PROGRAM.format(folder=str(tmp_path), name=f"whole{i}", numpy=True) for i in range(4)]
    processes = [spawn(program) for program in programs]
    assert all(process.communicate() and process.returncode == 0 for process in processes)
    assert len({(tmp_path / f"whole{i}").read_bytes() for i in range(4)}) == 1
    assert only_object(tmp_path / "store").read_bytes() == (tmp_path / "whole0").read_bytes()
    assert join(part).hit
