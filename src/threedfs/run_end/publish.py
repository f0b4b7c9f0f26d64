"""Copy the tables and plots of a run into the documentation (`make results`)."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from threedfs.errors import UserError
from threedfs.io.atomic import atomic
from threedfs.io.metrics import read_metrics, write_metrics
from threedfs.run_end.finish import TABLES

BEGIN = "<!-- made by `make results` from here -->"
END = "<!-- to here; own words go above or below -->"
_TITLES = {
    "iou": "Foreground IoU",
    "variants": "Terms and options of the joint segmentation, each off in turn",
    "iou_unseen": "Unseen views",
    "depth_experiment": "Depth from given poses: priors and measurements",
    "poses": "Poses",
    "meshes": "Meshes",
    "depth": "Depth maps of the keyframes",
    "doubts": "Doubtful truth",
    "costs": "Cost",
}
_PLOTS = {"iou": "iou_*.svg", "depth_experiment": "depth_*.svg"}
_NEW = f"# Results\n\n{BEGIN}\n{END}\n"


def publish(results: Path, docs: Path, *, figures_only: bool = False) -> None:
    """Write `results.csv`, `results.md` and `plots/*.svg` from the tables and plots of a folder of results.

    Of `results.md` only the part between the two marks is written; what stands around it is kept, and so are the rows
    of `results.csv` of data sets that the run has none of.

    Parameters
    ----------
    results, docs : Path
    figures_only : bool
        Write `results.csv` alone.

    Raises
    ------
    UserError
        If no run has left tables, or `results.md` has lost its marks.
    """
    figures = results / "metrics.csv"
    if not figures.is_file():
        raise UserError(f"{figures}: expected the figures of a run, found none; run snakemake first.")
    page = docs / "results.md"
    before, after = _read_own_words(page)  # before anything is written
    metrics = read_metrics(figures) + read_metrics(results / "benchmarks" / "costs.csv")
    measured = {metric.dataset for metric in metrics}
    earlier = read_metrics(docs / "results.csv") if (docs / "results.csv").is_file() else []
    write_metrics(docs / "results.csv", [*metrics, *(metric for metric in earlier if metric.dataset not in measured)])
    if figures_only:
        return
    plots = sorted((results / "plots").glob("*.svg"))
    for old in (docs / "plots").glob("*.svg"):
        old.unlink()
    for plot in plots:
        with atomic(docs / "plots" / plot.name) as temporary:
            temporary.write_bytes(plot.read_bytes())
    parts = [_section(name, results, [plot.name for plot in plots]) for name in (*TABLES, "costs")]
    made = "\n".join(part for part in parts if part)
    with atomic(page) as temporary:
        temporary.write_text(f"{before}{BEGIN}\n\n{made}\n{END}{after}", encoding="utf-8")


def _read_own_words(page: Path) -> tuple[str, str]:
    text = page.read_text(encoding="utf-8") if page.is_file() else _NEW
    before, begin, rest = text.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not (begin and end):
        raise UserError(
            f"{page}: expected the lines {BEGIN} and {END}, found them missing; put them where tables belong."
        )
    return before, after


def _section(name: str, results: Path, plots: list[str]) -> str:
    """Return the tables of a file under a heading, its plots first; nothing if the run made none."""
    file = results / ("benchmarks" if name == "costs" else "tables") / f"{name}.md"
    if not file.is_file():
        return ""
    drawn = [plot for plot in plots if Path(plot).match(_PLOTS.get(name, ""))] if name in _PLOTS else []
    images = "".join(f"![{Path(plot).stem}](plots/{plot})\n\n" for plot in drawn)
    text = file.read_text(encoding="utf-8").replace(f" in {Path.cwd()}.", ".")  # not the folder of one machine
    return f"## {_TITLES[name]}\n\n{images}{text}"


def main() -> None:
    """Publish what lies in `results/` into `docs/` of the folder that this is started in."""
    parser = argparse.ArgumentParser(description="Copy the tables and plots of a run into the documentation.")
    parser.add_argument("--figures-only", action="store_true", help="write docs/results.csv alone")
    given = parser.parse_args()
    try:
        publish(Path("results"), Path("docs"), figures_only=given.figures_only)
    except UserError as fault:
        sys.exit(f"threedfs: {fault}")


if __name__ == "__main__":
    main()
