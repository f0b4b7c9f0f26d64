"""Exact and rejection: what is kept of a sequence for the page over all of them."""

import pytest

from threedfs.run_end.due import is_due
from threedfs.run_end.summary import Summary, read_summary, write_summary


def test_a_summary_is_read_as_it_was_written(tmp_path):
    summary = Summary(("surface", "tsdf"), "surface", "All checks passed.", True, ("a <b>",), "data:,")
    write_summary(tmp_path, summary)
    assert read_summary(tmp_path) == summary


@pytest.mark.parametrize("text", [None, "", "[]", '{"other": 1}', "{"])
def test_none_is_read_where_there_is_none_or_another(tmp_path, text):
    if text is not None:
        (tmp_path / "report.json").write_text(text)
    assert read_summary(tmp_path) is None


def test_a_report_of_a_failure_is_made_anew_when_all_is_there(tmp_path):
    (tmp_path / "report.html").touch()
    write_summary(tmp_path, Summary(methods=("surface",), failures=("scale: no tag.",)))
    assert is_due(tmp_path, ["surface"], complete=True)
    assert not is_due(tmp_path, ["surface"], complete=False)
    write_summary(tmp_path, Summary(methods=("surface",)))
    assert not is_due(tmp_path, ["surface"], complete=True)
    assert is_due(tmp_path, ["fused_sdf"], complete=False)
