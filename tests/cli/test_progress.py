"""Exact and property: how far a run has come, by what it says."""

import io

import pytest

from threedfs.cli.progress import SECONDS, Progress, tell_time
from threedfs.cli.request import QUALITIES

STATS = ["Job stats:", "job        count", "-------  -------", "frames         1", "depth          2"]
STATS += ["collect        1", "all            1", "total          5"]


@pytest.fixture
def followed():
    """A progress that has seen the plan of a run: frames 6, depth 10 and 50."""
    stream = io.StringIO()
    progress = Progress(SECONDS["normal"], stream)
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


def test_jobs_that_were_not_planned_do_no_harm(followed):
    progress, _ = followed
    for line in ("Finished jobid: 3 (Rule: new)", "new of mug: 1/0", "", "a of b: 3/2)", "Job stats:", "total 0"):
        progress.follow(line)
    assert 0 <= progress.share <= 1


def test_a_file_gets_a_line_a_tenth(followed):
    progress, stream = followed
    progress.follow("Finished jobid: 3 (Rule: depth)")
    for count in range(1, 25):
        progress.follow(f"depth of mug 000120: done in 3.3 s ({count}/24)")
    lines = stream.getvalue().splitlines()
    assert 7 <= len(lines) <= 10
    assert all("depth" in line and "\r" not in line for line in lines[1:])


@pytest.mark.parametrize(("seconds", "text"), [(0, "0:00"), (59.6, "1:00"), (3600, "1:00:00")])
def test_times(seconds, text):
    assert tell_time(seconds) == text


def test_every_quality_has_its_shares():
    assert set(SECONDS) == set(QUALITIES)
    assert all(seconds > 0 for table in SECONDS.values() for each in table.values() for seconds in each)
