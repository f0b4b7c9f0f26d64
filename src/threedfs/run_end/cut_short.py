"""What a run that was killed at its very end leaves to the next one."""

from __future__ import annotations

from pathlib import Path


def ask_to_collect_again(results: Path) -> None:
    """Take `tables/metrics.csv` away if it is newer than `index.html`, which a run writes last of all.

    Such a run was killed between its last job and its last page. All its jobs are done, and the next run would find
    nothing to do, and write neither tables nor pages; now it collects figures, and writes what is missing.

    Parameters
    ----------
    results : Path
    """
    table, page = results / "tables/metrics.csv", results / "index.html"
    if table.is_file() and not (page.is_file() and page.stat().st_mtime_ns >= table.stat().st_mtime_ns):
        table.unlink(missing_ok=True)
