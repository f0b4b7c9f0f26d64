"""Exact: what jobs cost in earlier runs, on made-up records of a store."""

import os

import pytest

from threedfs.cli.costs import MEASURED
from threedfs.cli.earlier import find_costs
from threedfs.store.digests import digest_value
from threedfs.store.records import IDENTITY, MADE, record_path, write_record

CONFIG = {"store": "results/.store", "depth": {"iterations": 5}}
START = 1.5
WHEN = 1_700_000_000.0


@pytest.fixture
def out(tmp_path):
    """A folder with kernels and no sequence."""
    compiled(tmp_path, "other")
    return tmp_path


def compiled(out, code, when=WHEN - 5000.0):
    """Make a kernel of some code."""
    folder = out / "results/.store/kernels" / digest_value([{"code": code, "versions": {}}])[:16]
    (folder / "topic").mkdir(parents=True)
    kernel = folder / "topic/index.kernel"
    kernel.touch()
    os.utime(kernel, (when, when))


def record(out, sequence, log, *records):
    """Make the log of a job and the records of its actions."""
    (out / "results" / sequence / "02_poses").mkdir(parents=True, exist_ok=True)
    keys = []
    for own in records:
        identity = {"stage": log.rpartition("/")[2], "parameters": {}, "seed": 0, "wildcards": {}, "inputs": {}}
        identity |= {"code": "", "versions": {}} | {name: own[name] for name in own if name in IDENTITY}
        identity["inputs"] = {"log": [digest_value([sequence, log])]}
        made = {"outputs": {}, "bytes": {}, "seconds": 0.0, "peak_memory_mb": 0.0}
        made |= {name: own[name] for name in own if name in MADE}
        keys.append(digest_value(identity))
        store = out / "results/.store"
        write_record(store, keys[-1], identity, made)
        os.utime(record_path(store, keys[-1]), (WHEN, WHEN))
    log = out / "results" / sequence / f"{log}.log"
    log.parent.mkdir(parents=True, exist_ok=True)
    log.write_text("said something\n" + "".join(f"action {key}\n" for key in keys))


def seconds_of(costs, rule):
    return [cost.seconds for cost in costs.jobs[rule]]


def test_without_an_earlier_run_costs_are_as_measured(out):
    assert find_costs(out, "draft", CONFIG, 2) == MEASURED["draft"]


def test_without_kernels_they_are_compiled(tmp_path):
    assert find_costs(tmp_path, "normal", CONFIG, 2).cold


def test_a_rule_costs_what_it_did_and_others_stay(out):
    record(out, "mug", "logs/segment/joint", {"stage": "segment", "seconds": 40.0})
    costs = find_costs(out, "normal", CONFIG, 2)
    assert seconds_of(costs, "segment") == [40.0 + START]
    assert costs.jobs["surface"] == MEASURED["normal"].jobs["surface"]


def test_of_several_sequences_the_median_counts(out):
    for name, seconds in (("mug", 40.0), ("cup", 10.0), ("pot", 20.0)):
        record(out, name, "logs/segment/joint", {"stage": "segment", "seconds": seconds})
    assert seconds_of(find_costs(out, "normal", CONFIG, 2), "segment") == [20.0 + START]


def test_jobs_on_keyframes_share_the_cores_and_the_scene_pass_is_first(out):
    for log, seconds in (("03_scene/logs/depth", 1.0), ("logs/depth", 4.0)):
        own = [{"seconds": seconds, "wildcards": {"keyframe": f"{number:06}"}} for number in range(6)]
        own[0]["seconds"] = 99.0  # that one waited for kernels
        record(out, "mug", log, *own)
    assert seconds_of(find_costs(out, "normal", CONFIG, 2), "depth") == [3.0 + START, 12.0 + START]
    assert seconds_of(find_costs(out, "normal", CONFIG, 4), "depth") == [1.5 + START, 6.0 + START]


def test_compiling_is_taken_off(out):
    record(out, "mug", "logs/segment/joint", {"stage": "segment", "seconds": 40.0, "code": "mine"})
    compiled(out, "mine", WHEN - 30)
    compiling = MEASURED["normal"].jobs["segment"][0].compiling
    assert seconds_of(find_costs(out, "normal", CONFIG, 2), "segment") == [40.0 - compiling + START]


def test_a_run_with_other_parameters_says_nothing(out):
    record(out, "mug", "logs/segment/joint", {"stage": "segment", "seconds": 40.0})
    record(out, "mug", "logs/depth", {"seconds": 1.0, "parameters": {"iterations": 6}})
    assert find_costs(out, "normal", CONFIG, 2) == MEASURED["normal"]
    same = {**CONFIG, "depth": {"iterations": 6}}
    assert seconds_of(find_costs(out, "normal", same, 2), "segment") == [40.0 + START]


def test_damaged_records_and_settings_do_no_harm(out):
    record(out, "mug", "logs/segment/joint", {"stage": "segment", "seconds": 40.0})
    for path in out.rglob("actions/*/*.json"):
        path.write_text('{"stage": ')
    assert find_costs(out, "normal", {**CONFIG, "depth": 3}, 2) == MEASURED["normal"]
