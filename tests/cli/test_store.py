"""Contract: what `threedfs store` says and removes."""

from __future__ import annotations

import json
import os

import pytest

from threedfs.cli.main import main
from threedfs.store.digests import InputDigests, digest_value
from threedfs.store.objects import Objects
from threedfs.store.records import write_record


def add(out, sequence, stage, text, store=None):
    """Put the work of a stage on a sequence into a store; return its key."""
    store = store or out / "results/.store"
    built = out / "built"
    built.write_text(text)
    digest = Objects(store / "objects", InputDigests(store / "digests")).take_in(built)
    identity = {
        "stage": stage,
        "parameters": {},
        "seed": 0,
        "wildcards": {},
        "inputs": {},
        "code": text,
        "versions": {},
    }
    made = {"outputs": {"mesh": digest}, "bytes": {"mesh": len(text)}, "seconds": 1.0, "peak_memory_mb": 1}
    key = digest_value(identity)
    write_record(store, key, identity, made)
    if sequence:
        log = out / f"results/{sequence}/logs/{stage}.log"
        log.parent.mkdir(parents=True, exist_ok=True)
        log.write_text(f"{stage} of {sequence}: done\naction {key}\n")
    return key, store / "objects" / digest[:2] / digest


@pytest.fixture
def out(tmp_path):
    """A folder of results of two sequences, and of work that no result needs."""
    add(tmp_path, "mug", "depth", "d" * 1000)
    add(tmp_path, "cup", "poses", "p" * 3000)
    add(tmp_path, None, "depth", "o" * 5000)
    return tmp_path


def test_du_tells_sizes_by_stage_and_sequence(out, capsys):
    add(out, ".", "collect", "t" * 2000)
    assert main(["store", "du", "--out", str(out)]) == 0
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert ["stage", "depth", "6.0", "kB"] in lines and ["sequence", "cup", "3.0", "kB"] in lines
    assert ["sequence", "mug", "1.0", "kB"] in lines and ["objects", "11.0", "kB"] in lines
    assert ["sequence", "(tables", "of", "all)", "2.0", "kB"] in lines


def test_gc_lists_first_and_removes_what_no_result_needs(out, capsys):
    _, unneeded = add(out, None, "depth", "o" * 5000)
    kernel = out / "results/.store/kernels/old/x.nbc"
    kernel.parent.mkdir(parents=True)
    kernel.write_text("of before")
    looked, lately = (out / f"results/.store/inputs/{name}.json" for name in ("before", "lately"))
    looked.parent.mkdir()
    looked.write_text("{}")
    lately.write_text("{}")
    os.utime(looked, (1, 1))
    assert main(["store", "gc", "--out", str(out)]) == 0
    said = capsys.readouterr().out
    assert unneeded.name in said and "kernels/old/x.nbc" in said and "4 files" in said and unneeded.exists()
    assert main(["store", "gc", "--out", str(out), "--delete"]) == 0
    assert not unneeded.exists() and not kernel.exists() and not looked.exists() and lately.exists()
    assert main(["store", "verify", "--out", str(out)]) == 0
    assert "2 objects, 2 records" in capsys.readouterr().out


def test_gc_keeps_what_other_results_need(out, tmp_path):
    other = tmp_path / "other"
    (other / "results").mkdir(parents=True)
    _, needed = add(other, "jug", "depth", "j", store=out / "results/.store")
    words = ["store", "gc", "--delete", "--out", str(out)]
    assert main([*words, "--out", str(other)]) == 0
    assert needed.exists()
    assert main(words) == 0
    assert not needed.exists()


def test_gc_waits_for_jobs(out, capsys):
    beat = out / f"results/.store/claims/elsewhere.{os.getpid()}.x.beat"
    beat.parent.mkdir()
    beat.touch()
    assert main(["store", "gc", "--delete", "--out", str(out)]) == 1
    assert "expected no job at work, found elsewhere." in capsys.readouterr().err


def test_verify_names_damage_and_fails(out, capsys):
    assert main(["store", "verify", "--out", str(out)]) == 0
    _, path = add(out, None, "depth", "o" * 5000)
    path.chmod(0o644)
    path.write_text("wrong")
    assert main(["store", "verify", "--out", str(out)]) == 1
    told = capsys.readouterr()
    assert f"{path} is damaged" in told.out and "found 2 damaged files" in told.err  # it, and the record that names it


def test_adopt_tells_what_it_kept(out, capsys):
    key, _ = add(out, None, "depth", "o" * 5000)
    record = out / f"results/.store/actions/{key[:2]}/{key}.json"
    document = json.loads(record.read_text())
    for name in ("format", "key", "checksum"):
        del document[name]
    record.write_text(json.dumps(document))
    assert main(["store", "verify", "--out", str(out)]) == 0
    assert "1 records are of an older format" in capsys.readouterr().out
    assert main(["store", "adopt", "--out", str(out)]) == 0
    assert "1 records are used again, 0 are not" in capsys.readouterr().out


@pytest.mark.parametrize("what", ["du", "verify", "gc", "adopt"])
def test_a_folder_without_a_store_is_refused(tmp_path, capsys, what):
    assert main(["store", what, "--store", str(tmp_path)]) == 1
    assert f"--store: expected a store of finished work, found none at {tmp_path}" in capsys.readouterr().err
