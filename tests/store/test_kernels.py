"""Regression: a kernel is compiled anew when a kernel of another file that it calls is edited."""

from __future__ import annotations

PROGRAM = """
import io
from pathlib import Path
from threedfs.progress import Progress
from threedfs.store.action import Task
from threedfs.store.perform import perform
folder = Path({folder!r})
task = Task("join", {{"parts": folder / "a"}}, {{"whole": folder / "whole"}}, package="toolbox")
perform(task, folder / "store", progress=Progress("join", io.StringIO()))
print((folder / "whole").read_text())
"""
STAGE = '''"""A stage that computes with a kernel."""

from toolbox.outer import total


def run(*, parts, whole, job):
    """Write the kernel's result."""
    whole.write_text(str(total(3)))
'''
OUTER = '''"""A kernel that calls one of another file."""

from numba import njit

from toolbox.inner import weight


@njit(cache=True)
def total(count):
    """Add weights."""
    return count * weight()
'''
INNER = '''"""The kernel that is called."""

from numba import njit


@njit(cache=True)
def weight():
    """Return a constant."""
    return 1
'''


def test_edit_of_a_called_kernel_is_noticed(toolbox, tmp_path, spawn):
    (toolbox / "stages" / "join.py").write_text(STAGE)
    (toolbox / "outer.py").write_text(OUTER)
    (toolbox / "inner.py").write_text(INNER)
    (tmp_path / "a").write_text("")

    def perform() -> str:
        return spawn(PROGRAM.format(folder=str(tmp_path))).communicate()[0].strip()

    assert perform() == "3"
    before = {folder.name for folder in (tmp_path / "store" / "kernels").iterdir()}
    (toolbox / "inner.py").write_text(INNER.replace("return 1", "return 2"))
    assert perform() == "6"
    after = {folder.name for folder in (tmp_path / "store" / "kernels").iterdir()}
    assert len(before) == 1 and len(after) == 2 and before < after
    assert not list(toolbox.rglob("*.nbi"))  # nothing is left beside the sources, where it would be found again


def test_kernels_are_used_again_by_the_same_code(toolbox, tmp_path, spawn):
    (toolbox / "stages" / "join.py").write_text(STAGE)
    (toolbox / "outer.py").write_text(OUTER)
    (toolbox / "inner.py").write_text(INNER)

    def compiled_after(content: str) -> dict[str, int]:
        (tmp_path / "a").write_text(content)  # other input: the stage runs again
        assert spawn(PROGRAM.format(folder=str(tmp_path))).communicate()[0].strip() == "3"
        kernels = sorted((tmp_path / "store" / "kernels").rglob("*.kernel"))
        return {path.name: path.stat().st_mtime_ns for path in kernels}

    first = compiled_after("one")
    assert first
    assert compiled_after("two") == first
