"""Property: whatever is damaged in a store, nothing wrong is served, `verify` names it, and a run heals it."""

from __future__ import annotations

import io
import json
import os
import random
import shutil
from pathlib import Path

import pytest

from threedfs.progress import Progress
from threedfs.store.action import Task
from threedfs.store.audit import adopt_old, audit_store
from threedfs.store.perform import perform
from threedfs.store.records import BadRecord, parse_record

SPLIT = '''"""A stage with a file and a folder."""


def run(*, parts, whole, masks, job):
    """Write the parts, and a file for each letter."""
    job.progress.note("at work")
    whole.write_text(parts.read_text() * 20)
    (masks / "deep").mkdir(parents=True)
    for number, letter in enumerate(parts.read_text()):
        (masks / f"{number:06d}.png").write_text(letter)
    (masks / "deep" / "last.png").write_text("end")
'''


@pytest.fixture
def split(toolbox, tmp_path):
    """Perform a stage with two outputs; return whether it was a hit, and what was said."""
    (toolbox / "stages" / "split.py").write_text(SPLIT)
    (tmp_path / "a").write_text("one")

    def work():
        log = io.StringIO()
        outputs = {"whole": tmp_path / "whole", "masks": tmp_path / "masks"}
        task = Task("split", {"parts": tmp_path / "a"}, outputs, package="toolbox")
        outcome = perform(task, tmp_path / "store", progress=Progress("split", log))
        return outcome, log.getvalue()

    return work


def made(folder: Path) -> dict[str, str]:
    """Return what the stage made, by relative path."""
    files = [folder / "whole", *sorted(path for path in (folder / "masks").rglob("*") if path.is_file())]
    return {file.relative_to(folder).as_posix(): file.read_text() for file in files}


def clear(folder: Path) -> None:
    """Delete the results."""
    (folder / "whole").unlink(missing_ok=True)
    shutil.rmtree(folder / "masks", ignore_errors=True)


def record_of(store: Path) -> Path:
    """Return the one record of a store."""
    (path,) = (store / "actions").rglob("*.json")
    return path


def objects_of(store: Path) -> list[Path]:
    """Return the objects of a store."""
    return sorted(path for path in (store / "objects").rglob("*") if path.is_file())


def replace(path: Path, how: str, elsewhere: Path | None = None) -> None:
    """Put damage in the place of a file; what a link leads to lies beside the store unless told where."""
    content = path.read_bytes()
    path.unlink()
    match how:
        case "flip":
            path.write_bytes(bytes([content[0] ^ 4]) + content[1:])
        case "truncate":
            path.write_bytes(content[:-1])
        case "folder":
            (path / "inside").mkdir(parents=True)
        case "empty folder":
            path.mkdir()
        case "link":
            other = (elsewhere or path.parents[3]) / f"elsewhere-{path.name}"
            other.write_bytes(content)
            path.symlink_to(other)
        case "dangling link":
            path.symlink_to("nowhere")
        case "pipe":
            os.mkfifo(path)


def test_no_bit_of_a_record_can_be_flipped_unnoticed(split, tmp_path):
    key = split()[0].key
    data = record_of(tmp_path / "store").read_bytes()
    parse_record(data, key)
    for place in range(len(data)):
        for bit in range(8):
            flipped = data[:place] + bytes([data[place] ^ 1 << bit]) + data[place + 1 :]
            with pytest.raises(BadRecord):
                parse_record(flipped, key)


@pytest.mark.parametrize("part", range(10))
def test_a_flipped_bit_anywhere_in_a_record_is_a_miss_and_is_healed(split, tmp_path, part):
    split()
    right, path = made(tmp_path), record_of(tmp_path / "store")
    data = path.read_bytes()
    place = random.Random(part).randrange(part * len(data) // 10, (part + 1) * len(data) // 10)
    path.write_bytes(data[:place] + bytes([data[place] ^ 1 << place % 8]) + data[place + 1 :])
    assert len(audit_store(tmp_path / "store").damage) == 1
    clear(tmp_path)
    outcome, log = split()
    assert not outcome.hit and log.count("the record of this work is damaged") == 1
    assert made(tmp_path) == right and not audit_store(tmp_path / "store").damage
    assert split()[0].hit


@pytest.mark.parametrize(
    "how", ["flip", "truncate", "folder", "empty folder", "link", "dangling link", "pipe", "remove"]
)
@pytest.mark.parametrize("what", ["object", "record"])
def test_what_is_no_sound_file_is_named_and_healed(split, tmp_path, what, how):
    split()
    right, store = made(tmp_path), tmp_path / "store"
    path = record_of(store) if what == "record" else random.Random(how).choice(objects_of(store))
    replace(path, how)
    damage = audit_store(store).damage
    assert damage or (what, how) == ("record", "remove")
    assert any(path.name in sentence for sentence in damage) or how == "remove"
    clear(tmp_path)
    outcome, log = split()
    assert not outcome.hit and made(tmp_path) == right
    assert "the work is done again" in log or (what, how) == ("record", "remove")
    assert not audit_store(store).damage and split()[0].hit


def test_many_flipped_objects_are_all_named_and_healed(split, tmp_path):
    split()
    right, paths = made(tmp_path), objects_of(tmp_path / "store")
    for path in paths:
        replace(path, "flip")
    damage = audit_store(tmp_path / "store").damage
    assert all(any(str(path) in sentence for sentence in damage) for path in paths)
    split()
    assert made(tmp_path) == right and not audit_store(tmp_path / "store").damage


def test_a_folder_of_objects_that_became_a_file_is_healed(split, tmp_path):
    split()
    right, folder = made(tmp_path), objects_of(tmp_path / "store")[0].parent
    shutil.rmtree(folder)
    folder.write_text("no folder")
    split()
    assert made(tmp_path) == right and not audit_store(tmp_path / "store").damage


def test_a_record_under_another_key_is_refused(split, tmp_path):
    split()
    first = record_of(tmp_path / "store")
    (tmp_path / "a").write_text("two")
    second = tmp_path / "store/actions" / (key := split()[0].key)[:2] / f"{key}.json"
    right = made(tmp_path)
    second.write_bytes(first.read_bytes())
    assert any(key in sentence and "other work" in sentence for sentence in audit_store(tmp_path / "store").damage)
    outcome, log = split()
    assert not outcome.hit and "is that of other work" in log and made(tmp_path) == right


def downgrade(path: Path) -> None:
    """Write a record as older versions did."""
    document = json.loads(path.read_text())
    for name in ("format", "key", "checksum"):
        del document[name]
    path.write_text(json.dumps(document, sort_keys=True, indent=1) + "\n")


def test_an_older_record_is_a_miss_until_it_is_adopted(split, tmp_path):
    key = split()[0].key
    right, store = made(tmp_path), tmp_path / "store"
    downgrade(record_of(store))
    assert len(audit_store(store).old) == 1 and not audit_store(store).damage
    assert adopt_old(store) == (1, [])
    outcome, _ = split()
    assert outcome.hit and outcome.key == key and made(tmp_path) == right
    downgrade(record_of(store))
    outcome, log = split()
    assert not outcome.hit and "is of an older format" in log
    assert split()[0].hit


@pytest.mark.parametrize("fault", ["seed", "object", "size"])
def test_an_older_record_that_cannot_be_checked_is_not_adopted(split, tmp_path, fault):
    split()
    store = tmp_path / "store"
    path = record_of(store)
    downgrade(path)
    document = json.loads(path.read_text())
    if fault == "seed":
        document["seed"] = 7
    elif fault == "object":
        replace(objects_of(store)[0], "flip")
    else:
        document["bytes"]["masks"] += 1
    path.write_text(json.dumps(document))
    count, refused = adopt_old(store)
    assert count == 0 and len(refused) == 1
