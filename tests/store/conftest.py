"""A package of one stage, whose code and library versions the tests may change."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

STAGE = '''"""A stage that joins what it reads."""

from toolbox.topic import join


def run(*, parts, whole, job, **names):
    """Write the parts, joined."""
    job.progress.note("at work")
    whole.write_text(join([parts] if not isinstance(parts, list) else parts) + str(names))
'''
TOPIC = '''"""Joining."""


def join(paths):
    """Join the content of files and folders."""
    files = [file for path in paths for file in (sorted(path.rglob("*")) if path.is_dir() else [path])]
    return "+".join(file.read_text() for file in files if file.is_file())  # in order
'''
UNRELATED = '''"""Nothing imports this."""
'''


@pytest.fixture
def toolbox(tmp_path: Path, monkeypatch) -> Path:
    """The folder of the package `toolbox`."""
    package = tmp_path / "src" / "toolbox"
    for folder in (package, package / "stages", package / "params"):
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "__init__.py").write_text("")
    (package / "stages" / "join.py").write_text(STAGE)
    (package / "topic.py").write_text(TOPIC)
    (package / "unrelated.py").write_text(UNRELATED)
    monkeypatch.syspath_prepend(str(tmp_path / "src"))
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "kernels"))  # put back after `perform` has changed it
    # else Python runs the old bytecode where a test edits a source within a second and leaves its size the same
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    monkeypatch.setenv("PYTHONDONTWRITEBYTECODE", "1")
    yield package
    for name in [name for name in sys.modules if name.partition(".")[0] == "toolbox"]:
        del sys.modules[name]
    from threedfs.params.schema import find_params
    from threedfs.store import code

    find_params.cache_clear()
    code._package_folder.cache_clear()


@pytest.fixture
def spawn(tmp_path: Path):
    """Start a Python process that sees `toolbox`."""

    def start(program: str) -> subprocess.Popen:
        # where the tests themselves run in the background, an interrupt would be ignored
        start = "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler)"
        program = f"{start}; sys.path.insert(0, {str(tmp_path / 'src')!r})\n{program}"
        return subprocess.Popen(
            [sys.executable, "-c", program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

    return start
