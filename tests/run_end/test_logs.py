"""Exact: what logs tell of jobs that failed and of those that did not."""

import os

import pytest

from threedfs.evaluate.scores import Failure
from threedfs.run_end.logs import find_failures, read_actions, read_keys
from threedfs.store.digests import digest_value
from threedfs.store.records import IDENTITY, record_path, write_record

LOGS = {
    "mug/logs/poses.log": "poses of mug: at work\nthreedfs: poses of mug: expected motion: got none.\n",
    "mug/logs/depth/000010.log": "depth of mug 000010: at work\n",
    "can/logs/object/fused_sdf.log": "Traceback (most recent call last):\n  File\nIndexError: 3\n",
    "can/logs/frames.log": "frames of can: done in 1.0 s\naction abcd\n",
    "logs/collect.log": "",
}
SENTENCES = [
    ("can", "object", "fused_sdf", "IndexError: 3 (see RESULTS/can/logs/object/fused_sdf.log)"),
    (
        "",
        "collect",
        "",
        "ended without telling why, as when it is killed or memory runs out (see RESULTS/logs/collect.log)",
    ),
    (
        "mug",
        "depth",
        "000010",
        "ended without telling why, as when it is killed or memory runs out (see RESULTS/mug/logs/depth/000010.log)",
    ),
    ("mug", "poses", "", "expected motion: got none."),
]


@pytest.fixture
def results(tmp_path):
    """Logs of a run that began at time 1000."""
    for name, text in LOGS.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        os.utime(path, (2000, 2000))
    return tmp_path


def test_failed_jobs_tell_why_as_far_as_they_know(results):
    found = [
        Failure(failure.sequence, failure.stage, failure.item, failure.sentence.replace(str(results), "RESULTS"))
        for failure in find_failures(results, 1000)
    ]
    assert sorted(found, key=lambda failure: failure.stage) == sorted(
        (Failure(*values) for values in SENTENCES), key=lambda failure: failure.stage
    )


def test_logs_of_earlier_runs_are_left_alone(results):
    os.utime(results / "mug/logs/poses.log", (500, 500))
    assert not any(failure.stage == "poses" for failure in find_failures(results, 1000))


def test_actions_are_those_that_the_logs_end_with(results, tmp_path):
    identity = {name: {} for name in IDENTITY} | {"stage": "frames"}
    made = {"outputs": {"frames": "f" * 64}, "bytes": {"frames": 1}, "seconds": 1.0, "peak_memory_mb": 1}
    key, store = digest_value(identity), tmp_path / "store"
    write_record(store, key, identity, made)
    for log in (results / "can").rglob("*.log"):
        log.write_text(log.read_text().replace("action abcd", f"action {key}"))
    assert [record["stage"] for record in read_actions(results / "can", store)] == ["frames"]
    assert read_keys(results / "can") == {key}
    assert read_actions(results / "mug", store) == []
    record_path(store, key).write_text("{")
    assert read_actions(results / "can", store) == []  # a damaged record tells no costs


def test_log_of_a_job_on_many_keyframes_names_each_fault_and_each_action(tmp_path):
    log = tmp_path / "mug/logs/cues.log"
    log.parent.mkdir(parents=True)
    keys = [digest_value({name: {} for name in IDENTITY} | {"stage": stage}) for stage in ("edges", "cues")]
    actions = "".join(f"action {key}\n" for key in keys)
    log.write_text(
        actions + "threedfs: edges of mug IMG 1 and 2 more: no: edge.\nthreedfs: cues of mug IMG 4: killed.\n"
    )
    assert find_failures(tmp_path, 0) == [
        Failure("mug", "edges", "IMG 1 and 2 more", "no: edge."),
        Failure("mug", "cues", "IMG 4", "killed."),
    ]
    made = {"outputs": {"edges": "f" * 64}, "bytes": {"edges": 1}, "seconds": 1.0, "peak_memory_mb": 1}
    for key, stage in zip(keys, ("edges", "cues"), strict=True):
        write_record(tmp_path / "store", key, {name: {} for name in IDENTITY} | {"stage": stage}, made)
    stages = {record["stage"] for record in read_actions(tmp_path / "mug", tmp_path / "store")}
    assert stages == {"edges", "cues"}
    log.write_text(actions)
    assert find_failures(tmp_path, 0) == []
