"""Stage collect: the metrics tables of all sequences in one."""

from __future__ import annotations

from pathlib import Path

from threedfs.job import Job
from threedfs.store.files import write_atomically


def run(*, tables: list[Path], metrics: Path, job: Job) -> None:
    """Concatenate tables of the same columns."""
    header, *_ = tables[0].read_text(encoding="utf-8").splitlines()
    rows = [line for table in tables for line in table.read_text(encoding="utf-8").splitlines()[1:]]
    write_atomically(metrics, "\n".join([header, *rows, ""]).encode())
    job.progress.note(f"{len(rows)} figures of {len(tables)} tables")
