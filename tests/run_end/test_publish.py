"""Exact and rejection: what is published, and what is left alone."""

import pytest

from threedfs.errors import UserError
from threedfs.evaluate.scores import Metric
from threedfs.io.metrics import read_metrics, write_metrics
from threedfs.run_end.finish import TABLES
from threedfs.run_end.publish import BEGIN, END, publish


@pytest.fixture
def results(tmp_path):
    """What a run leaves behind."""
    folder = tmp_path / "results"
    write_metrics(folder / "metrics.csv", [Metric("iou_mean", 0.9, "1", "toys", "mug", "fused_sdf")])
    write_metrics(folder / "benchmarks/costs.csv", [Metric("seconds", 3.0, "s", "toys", "mug")])
    (folder / "tables").mkdir()
    (folder / "tables/iou.md").write_text(f"### IoU\n\nfailed: found no a.mp4 in {tmp_path}.\n")
    (folder / "benchmarks/costs.md").write_text("### Seconds\n")
    (folder / "plots").mkdir()
    (folder / "plots/iou_toys.svg").write_text("<svg/>")
    return folder


def test_tables_plots_and_figures_are_published(results, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    docs = tmp_path / "docs"
    publish(results, docs)
    assert [row.name for row in read_metrics(docs / "results.csv")] == ["iou_mean", "seconds"]
    text = (docs / "results.md").read_text()
    assert text.index("## Foreground IoU") < text.index("](plots/iou_toys.svg)") < text.index("### IoU")
    assert text.index("### IoU") < text.index("## Cost")
    assert "found no a.mp4." in text and str(tmp_path) not in text
    assert (docs / "plots/iou_toys.svg").read_text() == "<svg/>"


def test_whatever_table_a_run_makes_is_published_once_under_a_heading(results, tmp_path):
    docs = tmp_path / "docs"
    for name in TABLES:
        (results / f"tables/{name}.md").write_text(f"### Of {name}\n")
    publish(results, docs)
    lines = (docs / "results.md").read_text().splitlines()
    headings = [line for line in lines if line.startswith("## ")]
    assert len(set(headings)) == len(headings) == len(TABLES) + 1
    assert [line for line in lines if line.startswith("### Of ")] == [f"### Of {name}" for name in TABLES]


def test_figures_alone_leave_tables_and_plots_as_they_are(results, tmp_path):
    docs = tmp_path / "docs"
    publish(results, docs)
    before = {path: path.read_bytes() for path in docs.rglob("*") if path.is_file() and path.suffix != ".csv"}
    write_metrics(results / "metrics.csv", [Metric("iou_mean", 0.7, "1", "toys_printed", "mug", "fused_sdf")])
    write_metrics(results / "benchmarks/costs.csv", [Metric("seconds", 9.0, "s", "toys_printed", "mug")])
    (results / "tables/iou.md").write_text("### Newer\n")
    (results / "plots/iou_toys.svg").unlink()
    publish(results, docs, figures_only=True)
    assert {path: path.read_bytes() for path in docs.rglob("*") if path.is_file() and path.suffix != ".csv"} == before
    rows = read_metrics(docs / "results.csv")
    assert {(row.dataset, row.value) for row in rows} == {
        ("toys", 0.9),
        ("toys", 3.0),
        ("toys_printed", 0.7),
        ("toys_printed", 9.0),
    }


def test_own_words_are_kept_and_the_rest_is_replaced(results, tmp_path):
    docs = tmp_path / "docs"
    publish(results, docs)
    page = docs / "results.md"
    page.write_text(f"Mine.\n\n{page.read_text()}\nMine too.\n")
    (results / "tables/iou.md").write_text("### Newer\n")
    (results / "plots/iou_toys.svg").unlink()
    publish(results, docs)
    text = page.read_text()
    assert text.startswith("Mine.\n\n# Results") and text.endswith("Mine too.\n")
    assert "### Newer" in text and "### IoU" not in text
    assert text.count(BEGIN) == text.count(END) == 1
    assert not list((docs / "plots").iterdir())
    publish(results, docs)
    assert page.read_text() == text


def test_refuses_a_page_without_marks_and_a_run_without_tables(results, tmp_path):
    docs = tmp_path / "docs"
    docs.mkdir()
    (docs / "results.md").write_text("All mine.")
    with pytest.raises(UserError, match=r"results\.md: expected the lines"):
        publish(results, docs)
    assert not (docs / "results.csv").exists()
    with pytest.raises(UserError, match="expected the figures of a run"):
        publish(tmp_path / "nothing", docs)


def test_rows_of_other_data_sets_are_kept_and_those_of_this_one_replaced(results, tmp_path):
    docs = tmp_path / "docs"
    other = Metric("ods", 0.66, "1", "pictures", "all", "structured")
    write_metrics(docs / "results.csv", [Metric("iou_mean", 0.1, "1", "toys", "cup", "fused_sdf"), other])
    publish(results, docs)
    rows = read_metrics(docs / "results.csv")
    assert [(row.name, row.sequence) for row in rows] == [("iou_mean", "mug"), ("seconds", "mug"), ("ods", "all")]
    assert rows[-1] == other
