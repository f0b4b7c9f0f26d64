"""Exact and rejection: what is kept of a sequence for the page over all of them."""

import pytest

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
