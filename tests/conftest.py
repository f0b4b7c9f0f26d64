"""Kernels compiled from other sources than the present ones are never tested."""

from __future__ import annotations

import hashlib
import os
import shutil
import time
from pathlib import Path

import pytest

SOURCES = Path(__file__).resolve().parents[1] / "src"
KEPT_SECONDS = 7 * 86400.0


def pytest_configure(config):
    """Have numba keep kernels in pytest's cache, apart for every state of the sources, before it is imported.

    Of a kernel that calls kernels of other files, numba notices edits in its own file only.
    """
    digest = hashlib.sha256()
    for path in sorted(SOURCES.rglob("*.py")):
        digest.update(path.relative_to(SOURCES).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    kernels = config.cache.mkdir("kernels")
    present = kernels / digest.hexdigest()[:16]
    present.mkdir(exist_ok=True)
    os.utime(present)
    for folder in kernels.iterdir():
        if folder.stat().st_mtime < time.time() - KEPT_SECONDS:
            shutil.rmtree(folder, ignore_errors=True)
    os.environ["NUMBA_CACHE_DIR"] = str(present)


@pytest.fixture(autouse=True)
def environment_of_its_own():
    """Undo what a test does to the environment: a stage run in this process sets threads and folders for its own."""
    before = dict(os.environ)
    yield
    for name in set(os.environ) - set(before):
        del os.environ[name]
    os.environ.update(before)
