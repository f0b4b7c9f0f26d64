"""Property: a job never computes on a result that is not what its job wrote; fallback stores and full disks."""

from __future__ import annotations

import errno
import io
import os
import shutil
from pathlib import Path

import pytest

from threedfs.errors import UserError
from threedfs.progress import Progress
from threedfs.store import perform as module
from threedfs.store.action import Task
from threedfs.store.audit import Audit, audit_results, audit_store
from threedfs.store.digests import _CONFIRMED
from threedfs.store.made import Made
from threedfs.store.perform import perform

SPLIT = """
def run(*, parts, masks, job):
    masks.mkdir()
    for number, letter in enumerate(parts.read_text()):
        (masks / f"{number:06d}.png").write_text(letter)
"""


@pytest.fixture
def project(toolbox, tmp_path):
    """Perform the stages of a small project, as processes of their own would; return hit and what was said."""
    (toolbox / "stages" / "split.py").write_text(SPLIT)
    (tmp_path / "a").write_text("one")
    results = tmp_path / "results"

    def work(stage="join", parts=None, output="whole", seed=0, store="store", fallback=None):
        _CONFIRMED.clear()
        name = {"join": "whole", "split": "masks"}[stage]
        task = Task(stage, {"parts": parts or tmp_path / "a"}, {name: results / output}, seed=seed, package="toolbox")
        log = io.StringIO()
        fallback = tmp_path / fallback if fallback else None
        progress = Progress(stage, log)
        outcome = perform(task, tmp_path / store, progress=progress, fallback=fallback, made=results / ".made")
        return outcome.hit, log.getvalue()

    return work


def flip(path: Path, silently: bool) -> None:
    """Change a bit of a file, with the time of its last change or without."""
    status, data = path.stat(), path.read_bytes()
    path.chmod(0o644)
    path.write_bytes(bytes([data[0] ^ 1]) + data[1:])
    if silently:
        os.utime(path, ns=(status.st_atime_ns, status.st_mtime_ns))


@pytest.mark.parametrize("silently", [True, False])
def test_a_damaged_result_is_put_back_before_it_is_read(project, tmp_path, silently):
    project()
    whole = tmp_path / "results/whole"
    right = whole.read_text()
    flip(whole, silently)
    hit, log = project(parts=whole, output="next")
    assert not hit and f"{whole} is not what its job wrote; it is taken from the store again" in log
    assert whole.read_text() == right and right in (tmp_path / "results/next").read_text()


@pytest.mark.parametrize("silently", [True, False])
def test_damage_in_a_folder_of_results_is_put_back(project, tmp_path, silently):
    project("split", output="masks")
    masks = tmp_path / "results/masks"
    flip(masks / "000001.png", silently)
    (masks / "000002.png").unlink()
    _, log = project(parts=masks, output="next")
    assert "000001.png is not what its job wrote" in log and "000002.png is missing" in log
    assert (tmp_path / "results/next").read_text().startswith("o+n+e")


def test_damage_of_which_the_store_has_no_copy_is_told(project, tmp_path):
    project()
    whole = tmp_path / "results/whole"
    flip(whole, silently=False)
    shutil.rmtree(tmp_path / "store/objects")
    with pytest.raises(UserError, match=r"whole: expected the file that its job wrote.* delete .*whole and run again"):
        project(parts=whole, output="next")
    assert not (tmp_path / "results/next").exists()


def test_a_silent_change_of_a_file_that_no_job_made_is_other_work(project, tmp_path):
    project()
    flip(tmp_path / "a", silently=True)
    assert project()[0]  # a hit: nothing is read
    assert not project(seed=1)[0]
    assert (tmp_path / "results/whole").read_text().startswith((tmp_path / "a").read_text())


def test_what_another_store_has_made_meanwhile_counts(project, tmp_path):
    project()
    (tmp_path / "a").write_text("two")
    project(store="other")
    _, log = project(parts=tmp_path / "results/whole", output="next")
    assert "is not what its job wrote" not in log
    assert (tmp_path / "results/next").read_text().startswith("two")


@pytest.mark.parametrize("silently", [True, False])
def test_verify_names_damaged_results(project, tmp_path, silently):
    project()
    project("split", output="masks")
    audit = Audit()
    audit_results(tmp_path / "results", audit)
    assert not audit.damage and audit.results == 4
    flip(tmp_path / "results/whole", silently)
    flip(tmp_path / "results/masks/000000.png", silently)
    audit_results(tmp_path / "results", audit := Audit())
    assert len(audit.damage) == 2 and audit.results == 2


def test_hostile_notes_of_results_lead_nowhere(project, tmp_path):
    project()
    made = Made(tmp_path / "results/.made")
    made.remember(tmp_path / "a", "f" * 64)  # outside
    made.remember(tmp_path / "results/x", "../a")
    made.remember(tmp_path / "results/y", {"../../a": "f" * 64})
    assert [path.name for path, _ in made.list_all()] == ["whole"]
    for note in (tmp_path / "results/.made").rglob("*.json"):
        note.write_bytes(note.read_bytes().replace(b'"sha', b'"shb').replace(b"0", b"1"))
    assert made.find(tmp_path / "results/whole") is None


def test_hits_come_from_the_fallback_and_are_copied(project, tmp_path):
    project("split", output="masks")
    (tmp_path / "store").rename(tmp_path / "shared")
    before = {path: path.read_bytes() for path in (tmp_path / "shared").rglob("*") if path.is_file()}
    shutil.rmtree(tmp_path / "results")
    assert project("split", output="masks", fallback="shared")[0]
    assert project("split", output="masks")[0]  # now without it
    after = {path: path.read_bytes() for path in (tmp_path / "shared").rglob("*") if path.is_file()}
    assert after == before and not audit_store(tmp_path / "store").damage


def test_a_damaged_fallback_is_not_believed_and_not_changed(project, tmp_path):
    project("split", output="masks")
    (tmp_path / "store").rename(tmp_path / "shared")
    damaged = sorted(path for path in (tmp_path / "shared/objects").rglob("*") if path.is_file())[0]
    flip(damaged, silently=False)
    wrong = damaged.read_bytes()
    hit, log = project("split", output="masks", fallback="shared")
    assert not hit and "is damaged, so the work is done again" in log
    assert damaged.read_bytes() == wrong and not audit_store(tmp_path / "store").damage


def test_a_damaged_object_is_taken_from_the_fallback(project, tmp_path):
    project()
    shutil.copytree(tmp_path / "store", tmp_path / "shared")
    (damaged,) = (path for path in (tmp_path / "store/objects").rglob("*") if path.is_file())
    flip(damaged, silently=False)
    assert project(fallback="shared")[0]
    assert (tmp_path / "results/whole").read_text().startswith("one")


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EROFS, errno.EDQUOT])
def test_a_full_disk_or_a_store_that_is_only_read_ends_in_a_sentence(project, tmp_path, monkeypatch, number):
    project()

    def refuse(*_, **__):
        raise OSError(number, os.strerror(number), str(tmp_path / "store/actions/x"))

    monkeypatch.setattr(module, "write_record", refuse)
    with pytest.raises(UserError, match=rf"{os.strerror(number)}; free space, or name another folder as `store`"):
        project(seed=1, output="next")
    assert (tmp_path / "results/whole").read_text().startswith("one") and not (tmp_path / "results/next").exists()
    assert not any((tmp_path / "store/scratch").iterdir())
    assert project()[0]


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_hits_come_from_a_store_that_is_only_read(project, tmp_path):
    project()
    for path in [tmp_path / "store", *(tmp_path / "store").rglob("*")]:
        path.chmod(path.stat().st_mode & ~0o222)
    assert project()[0]
    with pytest.raises(UserError, match="free space, or name another folder"):
        project(seed=1)
