"""What the logs of a run tell: which jobs failed and why, and what the others cost."""

from __future__ import annotations

from pathlib import Path

from threedfs.evaluate.scores import Failure
from threedfs.store.records import BadRecord, is_digest, read_record

_DONE = "action "
_REFUSED = "threedfs: "


def find_failures(results: Path, since: float) -> list[Failure]:
    """Find the jobs that began after a time and did not end well, in the order of their logs' names.

    A job that ended well has told, in the last lines of its log, the actions that it did.

    Parameters
    ----------
    results : Path
        Holds the logs: `SEQUENCE/logs/RULE.log`, or `SEQUENCE/logs/RULE/ITEM.log` for one method.
    since : float
        Seconds since the epoch.
    """
    failures = []
    for log in _find_logs(results):
        lines = _read_lines(log)
        if log.stat().st_mtime >= since and not (lines and lines[-1].startswith(_DONE)):
            folder, _, place = log.relative_to(results).with_suffix("").as_posix().partition("logs/")
            sequence = folder.partition("/")[0]  # those of the scene pass lie a folder deeper
            rule, _, item = place.partition("/")
            refused = [line.removeprefix(_REFUSED) for line in lines if line.startswith(_REFUSED)]
            failures += [_read_refusal(line, sequence, item) for line in refused]
            if not refused:
                failures.append(Failure(sequence, rule, item, _explain(lines, log)))
    return failures


def read_actions(folder: Path, store: Path) -> list[dict]:
    """Read the records of the actions that the jobs of a sequence did, which their logs name."""
    lines = (line for log in _find_logs(folder) for line in _read_lines(log))
    keys = sorted(line.removeprefix(_DONE) for line in lines if line.startswith(_DONE))
    records = (_read_record(store, key) for key in keys)
    return [record for record in records if record is not None]


def read_keys(folder: Path) -> set[str]:
    """Return the keys of the actions that the jobs of a sequence did, which their logs name."""
    lines = (line for log in _find_logs(folder) for line in _read_lines(log))
    return {key for line in lines if line.startswith(_DONE) and is_digest(key := line.removeprefix(_DONE))}


def _read_record(store: Path, key: str) -> dict | None:
    """Read a record; one that is damaged tells no costs."""
    try:
        return read_record(store, key) if is_digest(key) else None
    except BadRecord:
        return None


def _read_refusal(line: str, sequence: str, item: str) -> Failure:
    """Read `STAGE of SEQUENCE ITEM: sentence`; what the log's place tells of the item goes before."""
    label, _, sentence = line.partition(": ")
    stage, _, what = label.partition(" of ")
    return Failure(sequence, stage, item or what.partition(" ")[2], sentence.removeprefix(f"{stage}: "))


def _explain(lines: list[str], log: Path) -> str:
    if any(line.startswith("Traceback ") for line in lines):
        return f"{lines[-1]} (see {log})"
    return f"ended without telling why, as when it is killed or memory runs out (see {log})"


def _read_lines(log: Path) -> list[str]:
    return log.read_text(encoding="utf-8", errors="replace").rstrip().splitlines()


def _find_logs(folder: Path) -> list[Path]:
    return sorted(path for path in folder.rglob("*.log") if "logs" in path.relative_to(folder.parent).parts)
