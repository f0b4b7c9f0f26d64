"""What the logs of a run tell: which jobs failed and why, and what the others cost."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from threedfs.evaluate.scores import Failure
from threedfs.store.records import BadRecord, is_digest, read_record, record_path

_DONE = "action "
_REFUSED = "threedfs: "


@dataclass(frozen=True)
class Action:
    """What was done once, also if a job then took it from the store.

    Attributes
    ----------
    rule : str
        Of the job, by the place of its log.
    key : str
    record : mapping
        Of the store.
    recorded : float
        When it was done, seconds since the epoch.
    """

    rule: str
    key: str
    record: Mapping[str, Any]
    recorded: float


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


def read_actions(folder: Path, store: Path) -> list[Mapping[str, Any]]:
    """Read the records of the actions that the jobs of a sequence did, which their logs name."""
    actions = sorted((action for job in read_jobs(folder, store) for action in job), key=lambda action: action.key)
    return [action.record for action in actions]


def read_keys(folder: Path) -> set[str]:
    """Return the keys of the actions that the jobs of a sequence did, which their logs name."""
    return {key for log in _find_logs(folder) for key in _read_keys(log)}


def read_jobs(folder: Path, store: Path) -> list[list[Action]]:
    """Read the actions that each job of a sequence did, those of the scene pass first; damaged records tell nothing."""
    jobs = []
    for log in _find_logs(folder):
        rule = log.relative_to(folder).as_posix().rpartition("logs/")[2].removesuffix(".log").partition("/")[0]
        jobs.append(list(_read_actions(rule, _read_keys(log), store)))
    return [job for job in jobs if job]


def _read_keys(log: Path) -> list[str]:
    keys = [line.removeprefix(_DONE) for line in _read_lines(log) if line.startswith(_DONE)]
    return [key for key in keys if is_digest(key)]


def _read_actions(rule: str, keys: list[str], store: Path) -> Iterator[Action]:
    for key in keys:
        try:
            record = read_record(store, key)
            if record is not None:
                yield Action(rule, key, record, record_path(store, key).stat().st_mtime)
        except (BadRecord, OSError):
            continue


def _read_refusal(line: str, sequence: str, item: str) -> Failure:
    """Read `STAGE of SEQUENCE ITEM: sentence`; what the log's place tells of the item goes before."""
    label, _, sentence = line.partition(": ")
    stage, _, what = label.partition(" of ")
    return Failure(sequence, stage, item or what.partition(" ")[2], sentence)


def _explain(lines: list[str], log: Path) -> str:
    if any(line.startswith("Traceback ") for line in lines):
        return f"{lines[-1]} (see {log})"
    return f"ended without telling why, as when it is killed or memory runs out (see {log})"


def _read_lines(log: Path) -> list[str]:
    return log.read_text(encoding="utf-8", errors="replace").rstrip().splitlines()


def _find_logs(folder: Path) -> list[Path]:
    return sorted(path for path in folder.rglob("*.log") if "logs" in path.relative_to(folder.parent).parts)
