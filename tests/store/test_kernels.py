"""Property: a kernel is read only if it is of the present code, whole, and put there by nobody else."""

from __future__ import annotations

import random

import pytest

from threedfs.store.audit import audit_store
from threedfs.store.kernels import choose_folder, read_kernel, write_kernel

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


TELLING = """
import io
from pathlib import Path
from threedfs.progress import Progress
from threedfs.store.action import Task
from threedfs.store.perform import perform
folder, log = Path({folder!r}), io.StringIO()
task = Task("join", {{"parts": folder / "a"}}, {{"whole": folder / "whole"}}, package="toolbox")
perform(task, folder / "store", progress=Progress("join", log))
print((folder / "whole").read_text(), log.getvalue())
"""


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


@pytest.fixture
def compiled(toolbox, tmp_path, spawn, monkeypatch):
    """Do the work on some content in a process of its own; return what it said."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    (toolbox / "stages" / "join.py").write_text(STAGE)
    (toolbox / "outer.py").write_text(OUTER)
    (toolbox / "inner.py").write_text(INNER)

    def work(content: str) -> str:
        (tmp_path / "a").write_text(content)
        process = spawn(TELLING.format(folder=str(tmp_path)))
        said = process.communicate()[0]
        assert process.returncode == 0
        return said

    return work


def kernels_of(store):
    """Return the kernels of a store, by path, with their bytes."""
    return {path: path.read_bytes() for path in sorted((store / "kernels").rglob("*.kernel"))}


def test_damaged_kernels_are_named_and_compiled_again(compiled, tmp_path):
    assert compiled("one").startswith("3 ")
    right = kernels_of(tmp_path / "store")
    assert len(right) >= 1 and not audit_store(tmp_path / "store").damage
    draw = random.Random(0)
    for path, data in right.items():
        place = draw.randrange(len(data))
        path.write_bytes(data[:place] + bytes([data[place] ^ 1 << draw.randrange(8)]) + data[place + 1 :])
    damage = audit_store(tmp_path / "store").damage
    assert all(any(str(path) in sentence for sentence in damage) for path in right)
    assert compiled("two").startswith("3 ")
    assert not audit_store(tmp_path / "store").damage and set(kernels_of(tmp_path / "store")) == set(right)


def test_no_flipped_or_missing_byte_of_a_kernel_is_read(tmp_path):
    path = tmp_path / "state" / "a.kernel"
    write_kernel(tmp_path, path, b"machine code")
    data = path.read_bytes()
    assert read_kernel(tmp_path, path) == b"machine code"
    for place in range(len(data)):
        for bit in range(8):
            path.write_bytes(data[:place] + bytes([data[place] ^ 1 << bit]) + data[place + 1 :])
            assert read_kernel(tmp_path, path) is None
        path.write_bytes(data[:place])
        assert read_kernel(tmp_path, path) is None


def test_a_kernel_of_another_place_is_not_read(tmp_path):
    for name in ("a", "b"):
        write_kernel(tmp_path, tmp_path / f"state/{name}.kernel", name.encode())
    (tmp_path / "state/a.kernel").write_bytes((tmp_path / "state/b.kernel").read_bytes())
    assert read_kernel(tmp_path, tmp_path / "state/a.kernel") is None
    assert read_kernel(tmp_path, tmp_path / "state/b.kernel") == b"b"


def test_a_kernel_that_others_can_write_to_is_not_read(tmp_path):
    path = tmp_path / "a.kernel"
    write_kernel(tmp_path, path, b"x")
    path.chmod(0o666)
    assert read_kernel(tmp_path, path) is None


@pytest.mark.parametrize("what", ["store", "store/kernels"])
def test_kernels_of_a_store_that_others_can_write_to_are_not_used(compiled, tmp_path, what):
    (tmp_path / "store/kernels").mkdir(parents=True)
    (tmp_path / what).chmod(0o777)
    said = compiled("one")
    assert said.startswith("3 ") and f"so compiled kernels are kept in {tmp_path / 'cache'}" in said
    assert not kernels_of(tmp_path / "store") and list((tmp_path / "cache").rglob("*.kernel"))
    if what == "store/kernels":
        (tmp_path / what / "planted.kernel").write_bytes(b"0" * 70)
        assert any("can be written to by others" in sentence for sentence in audit_store(tmp_path / "store").damage)


def test_a_link_in_the_place_of_the_kernels_is_not_used(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    (tmp_path / "store").mkdir()
    (tmp_path / "other").mkdir()
    (tmp_path / "store/kernels").symlink_to(tmp_path / "other")
    folder, reason = choose_folder(tmp_path / "store")
    assert folder == tmp_path / "cache/threedfs/kernels" and reason


def test_without_any_private_folder_kernels_are_forgotten(tmp_path, monkeypatch):
    (tmp_path / "cache").write_text("no folder")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    (tmp_path / "store").mkdir(mode=0o777)
    (tmp_path / "store").chmod(0o777)
    folder, reason = choose_folder(tmp_path / "store")
    assert folder.is_dir() and "compiled again next time" in reason
    folder.rmdir()
