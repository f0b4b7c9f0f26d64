"""Exact and property: how far a run has come and how long it will take, by what it says."""

import io
from collections import Counter
from dataclasses import replace

import pytest
from recorded_runs import RUNS

from threedfs.cli.costs import MEASURED, Cost, Costs, Size
from threedfs.cli.progress import Progress, tell_time
from threedfs.cli.request import QUALITIES

STATS = ["Job stats:", "job        count", "-------  -------", "frames         1", "depth          2"]
STATS += ["collect        1", "all            1", "total          5"]
COSTS = Costs({"frames": (Cost(6),), "depth": (Cost(10), Cost(50, grows=("pixels",)))}, Size(pixels=100))
EACH = ("scout", "depth", "cues")
"""Rules whose jobs tell of every keyframe."""


@pytest.fixture
def followed():
    """A progress that has seen the plan of a run: frames 6, depth 10 and 50."""
    stream = io.StringIO()
    progress = Progress(COSTS, stream)
    for line in STATS:
        progress.follow(line)
    return progress, stream


def test_nothing_is_done_at_first(followed):
    progress, _ = followed
    assert progress.share == 0
    assert progress.left() is None


def test_finished_jobs_count_by_their_cost(followed):
    progress, _ = followed
    progress.follow("Finished jobid: 4 (Rule: frames)")
    assert progress.share == pytest.approx(6 / 66)
    progress.follow("Finished jobid: 3 (Rule: depth)")
    assert progress.share == pytest.approx(16 / 66)
    assert progress.left() is not None
    progress.follow("Finished jobid: 2 (Rule: depth)")
    assert progress.share == pytest.approx(1)


def test_a_part_of_a_job_counts(followed):
    progress, _ = followed
    progress.follow("Finished jobid: 3 (Rule: depth)")
    progress.follow("depth of mug 000120: done in 3.3 s (3/24)")
    assert progress.share == pytest.approx((10 + 50 * 3 / 24) / 66)
    progress.follow("depth of mug 000120: neighbour 5/7")  # a phase within a keyframe is none of the job
    assert progress.share == pytest.approx((10 + 50 * 3 / 24) / 66)


def test_what_a_job_says_behind_another_s_end_counts(followed):
    progress, _ = followed
    progress.follow("Finished jobid: 3 (Rule: depth)depth of mug 000120: done in 3.3 s (3/24)")
    assert progress.share == pytest.approx((10 + 50 * 3 / 24) / 66)


def test_what_is_taken_from_the_store_says_nothing_of_the_speed(followed):
    progress, _ = followed
    progress.follow("frames of mug: taken from the store in 0.1 s")
    progress.follow("Finished jobid: 3 (Rule: frames)")
    for count in range(24):
        progress.follow(f"depth of mug {count:06}: taken from the store in 0.0 s ({count + 1}/24)")
    progress.follow("Finished jobid: 3 (Rule: depth)")
    assert progress.share == pytest.approx(1 / 51)


def test_a_larger_input_has_more_to_do(followed):
    _, stream = followed
    progress = Progress(COSTS, stream, measure=lambda name: Size(pixels={"mug": 300}[name]))
    for line in [*STATS, "Finished jobid: 4 (Rule: frames)", "crops of mug: done in 4.4 s"]:
        progress.follow(line)
    assert progress.share == pytest.approx(6 / (6 + 10 + 150))


@pytest.mark.parametrize("seconds", [12.0, 60.0])
def test_a_job_whose_time_varies_with_the_images_says_nothing_of_the_speed(seconds):
    now = 0.0
    costs = Costs({"frames": (Cost(6),), "poses": (Cost(12, varies=True),), "depth": (Cost(50),)}, Size())
    progress = Progress(costs, io.StringIO(), clock=lambda: now)
    for line in ("Job stats:", "frames 1", "poses 1", "depth 1", "total 3"):
        progress.follow(line)
    now = 6.0
    progress.follow("Finished jobid: 3 (Rule: frames)")
    progress.follow("poses of mug: 120 frames")
    now += seconds
    assert progress.left() == pytest.approx(12 + 50)
    progress.follow("Finished jobid: 2 (Rule: poses)")
    assert progress.left() == pytest.approx(50)
    now += 50.0  # twice the cost for half of the work
    progress.follow("depth of mug 000120: done in 3.3 s (12/24)")
    assert progress.left() == pytest.approx(25 * (5 + 6 + 50) / (5 + 6 + 25))


def test_jobs_that_were_not_planned_do_no_harm(followed):
    progress, _ = followed
    for line in ("Finished jobid: 3 (Rule: new)", "new of mug: 1/0", "", "a of b: (3/2)", "Job stats:", "total 0"):
        progress.follow(line)
    assert 0 <= progress.share <= 1


def test_a_file_gets_a_line_a_tenth(followed):
    _, stream = followed
    journal = io.StringIO()
    progress = Progress(COSTS, stream, journal)
    for line in [*STATS, "Finished jobid: 3 (Rule: depth)"]:
        progress.follow(line)
    for count in range(1, 25):
        progress.follow(f"depth of mug 000120: done in 3.3 s ({count}/24)")
    lines = journal.getvalue().splitlines()
    assert 7 <= len(lines) <= 10
    assert all("depth" in line and "left" in line and "\r" not in line for line in lines[1:])
    assert stream.getvalue() == journal.getvalue()


def test_a_terminal_has_one_line_and_the_file_its_own():
    terminal, journal = io.StringIO(), io.StringIO()
    terminal.isatty = lambda: True
    seconds = iter(range(100))
    progress = Progress(COSTS, terminal, journal, clock=lambda: float(next(seconds)))
    for line in [*STATS, "Finished jobid: 4 (Rule: frames)", "Finished jobid: 3 (Rule: depth)"]:
        progress.follow(line)
    progress.show(last=True)
    assert terminal.getvalue().count("\n") == 1 and terminal.getvalue().count("\r\033[K") > 2
    assert journal.getvalue().count("\n") == 1 and "\r" not in journal.getvalue()


def replay(run, costs, until):
    """Return the seconds that a recorded run is said to have left after some time."""
    now = 0.0
    progress = Progress(costs, io.StringIO(), measure=lambda name: run.size, clock=lambda: now)
    plan = Counter(rule for rule, _ in run.jobs)
    lines = [(0.0, line) for line in ("Job stats:", *(f"{rule} {count}" for rule, count in plan.items()), "total 9")]
    begun = 0.0
    for rule, end in run.jobs:
        how = "taken from the store" if rule in run.taken else "done"
        if rule == "frames":
            lines.append((end, f"frames of mug: {run.size.frames} of 999 frames taken"))
        if rule == "keyframes":
            lines.append((end, f"keyframes of mug: {run.size.keyframes} keyframes of 999 frames"))
        if rule in EACH:
            count = run.size.keyframes
            each = ((begun + (end - begun) * part / count, part) for part in range(1, count + 1))
            lines += [(when, f"{rule} of mug {part:06}: {how} in 1.0 s ({part}/{count})") for when, part in each]
        else:
            lines.append((begun, f"{rule} of mug: begun"))
            lines.append((end, f"{rule} of mug: {how} in 1.0 s"))
        lines.append((end, f"Finished jobid: 1 (Rule: {rule})"))
        begun = end
    for when, line in lines:
        if when <= until:
            now = when
            progress.follow(line)
    now = until
    return progress.left()


@pytest.mark.parametrize("name", RUNS)
def test_at_half_time_the_rest_of_a_recorded_run_is_known_within_30_percent(name):
    run = RUNS[name]
    left = replay(run, replace(MEASURED[run.quality], cold=run.cold), run.seconds / 2)
    assert left == pytest.approx(run.seconds / 2, rel=0.3)


@pytest.mark.parametrize("name", RUNS)
@pytest.mark.parametrize("slower", [0.5, 3.0])
def test_a_machine_of_another_speed_is_known_at_half_time(name, slower):
    run = RUNS[name]
    ends = " ".join(f"{rule}:{end * slower}" for rule, end in run.jobs)
    other = replace(run, ends=ends, seconds=run.seconds * slower)
    left = replay(other, replace(MEASURED[run.quality], cold=run.cold), other.seconds / 2)
    assert left == pytest.approx(other.seconds / 2, rel=0.3, abs=6.0)  # seconds, which count where a run takes 24


@pytest.mark.parametrize("name", [name for name, run in RUNS.items() if run.quality == "normal"])
def test_costs_of_one_run_tell_those_of_another_within_30_percent(name):
    """The costs are those of a run of another video; the measured table of all of them has no part in it."""
    run = RUNS[name]
    other = RUNS["phone video" if "sample" in name else "sample"]
    begun, seconds = 0.0, {}
    for rule, end in other.jobs:
        seconds.setdefault(rule, []).append(end - begun)
        begun = end
    own = {rule: each for rule, each in seconds.items() if len(each) == len(MEASURED["normal"].jobs[rule])}
    costs = replace(MEASURED["normal"].with_seconds(own), size=other.size, cold=run.cold)
    assert replay(run, costs, run.seconds / 2) == pytest.approx(run.seconds / 2, rel=0.3)


@pytest.mark.parametrize(("seconds", "text"), [(0, "0:00"), (59.6, "1:00"), (3600, "1:00:00")])
def test_times(seconds, text):
    assert tell_time(seconds) == text


def test_every_quality_has_its_costs():
    assert set(MEASURED) == set(QUALITIES)
    jobs = [cost for costs in MEASURED.values() for each in costs.jobs.values() for cost in each]
    assert all(cost.seconds > 0 for cost in jobs)
