"""Property: no record, however made, writes or deletes anything outside of its output's folder."""

from __future__ import annotations

import io
import json
import random
from pathlib import Path

import pytest

from threedfs.progress import Progress
from threedfs.store.action import Task, identify
from threedfs.store.digests import InputDigests, digest_value
from threedfs.store.objects import DamagedObject, Objects
from threedfs.store.perform import fetch
from threedfs.store.place import Store
from threedfs.store.records import BadRecord, parse_record, record_path, write_record

NAMES = ["a.png", "../out", "..", ".", "", "/etc/x", "deep/../../out", "a//b", "a/", "./a", "\0", "\ud800", "n" * 300]
NAMES += ["a.png/b", "x/" * 700 + "x", "deep/b.png"]
VALUES = [None, 1, "", "x", [], {}, "../../victim", "f" * 63, "F" * 64, "f" * 64 + "\n", [["f" * 64]], 1e308, True]


@pytest.fixture
def place(toolbox, tmp_path):
    """A store with one object, beside a file that nobody may touch; what identifies an action; its task."""
    (tmp_path / "a").write_text("one")
    victim = tmp_path / "victim"
    victim.write_text("precious")
    inside = tmp_path / "inside"
    inside.mkdir()
    store, built = Store(inside / "store"), tmp_path / "built"
    built.write_text("object")
    objects = Objects(store.folder / "objects", InputDigests(store.folder / "digests"))
    digest = objects.take_in(built)
    task = Task("join", {"parts": tmp_path / "a"}, {"whole": inside / "whole"}, package="toolbox")
    return store, identify(task, InputDigests(store.folder / "digests")), digest, victim


def snapshot(folder: Path, without: Path) -> dict[str, bytes]:
    """Return all files of a folder, without those of another in it."""
    files = (path for path in sorted(folder.rglob("*")) if path.is_file() and without not in path.parents)
    return {str(path): path.read_bytes() for path in files}


def draw_content(draw: random.Random, good: str, victim: Path):
    """Make up what an output holds."""
    digests = [good, good, *VALUES, str(victim), f"../{victim}"]
    if draw.random() < 0.3:
        return draw.choice(digests)
    return {draw.choice(NAMES): draw.choice(digests) for _ in range(draw.randrange(4))}


def test_sealed_records_of_any_content_stay_inside(place, tmp_path):
    store, action, good, victim = place
    identity = {**action.source, **action.maker}
    before, served = snapshot(tmp_path, store.folder.parent), 0
    for number in range(1500):
        draw = random.Random(number)
        outputs = {"whole": draw_content(draw, good, victim)}
        if draw.random() < 0.1:
            outputs[draw.choice(NAMES)] = good
        made = {"outputs": outputs, "bytes": {name: 6 for name in outputs}, "seconds": 1, "peak_memory_mb": 1}
        if draw.random() < 0.2:
            made[draw.choice([*made])] = draw.choice(VALUES)
        write_record(store.folder, action.key, identity, made)
        served += fetch(action, store, Progress("x", io.StringIO())) is not None
        assert snapshot(tmp_path, store.folder.parent) == before
        assert {path.name for path in store.folder.parent.iterdir()} <= {"store", "whole"}
    assert 20 < served < 1000  # some are possible, and those are served


def test_random_changes_of_a_record_are_refused(place):
    store, action, good, _ = place
    made = {"outputs": {"whole": good}, "bytes": {"whole": 6}, "seconds": 1, "peak_memory_mb": 1}
    write_record(store.folder, action.key, {**action.source, **action.maker}, made)
    data = record_path(store.folder, action.key).read_bytes()
    document = parse_record(data, action.key)
    for number in range(1000):
        draw = random.Random(number)
        changed = dict(document)
        name = draw.choice([*changed])
        if draw.random() < 0.3:
            del changed[name]
        else:
            changed[name] = draw.choice(VALUES)
        if draw.random() < 0.5 and "checksum" in changed:
            changed["checksum"] = digest_value({key: value for key, value in changed.items() if key != "checksum"})
        text = json.dumps(changed, sort_keys=True, indent=1).encode() + b"\n"
        if text != data and changed | {"seconds": 0, "checksum": ""} != document | {"seconds": 0, "checksum": ""}:
            if name not in ("seconds", "peak_memory_mb") or not isinstance(changed.get(name), (int, float)):
                with pytest.raises(BadRecord):
                    parse_record(text, action.key)
    for garbage in (b"", b"[" * 100000, b"null", b"1e999", b"{}", b"\xff\xfe", b'{"seed": ' + b"9" * 5000 + b"}"):
        with pytest.raises(BadRecord):
            parse_record(garbage, action.key)


@pytest.mark.parametrize("digest", ["", "..", "../../victim", "f" * 63, "F" * 64, "f" * 64 + "/x", None, 3])
def test_a_digest_that_is_none_names_no_path(place, tmp_path, digest):
    store, _, _, victim = place
    objects = Objects(store.folder / "objects", InputDigests(store.folder / "digests"))
    with pytest.raises(DamagedObject):
        objects.path(digest)
    with pytest.raises(DamagedObject):
        objects.check_out({"a": str(victim)}, tmp_path / "target")
    assert victim.read_text() == "precious" and not (tmp_path / "target").exists()
