"""Contract: the tree names no machine and no host, and builds from hashed pins alone."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ("src", "workflow", "config", "profiles", "envs", ".ci", "benchmarks")
TEXTS = [
    path
    for folder in FOLDERS
    for path in sorted((ROOT / folder).rglob("*"))
    if path.suffix in {".py", ".smk", ".yaml", ".md", ".txt", ".in", ".toml", ""} and path.is_file()
] + [ROOT / name for name in ("Snakefile", "Makefile", "pyproject.toml")]


@pytest.mark.parametrize("path", TEXTS, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_no_file_names_a_host_or_a_folder_of_one_machine(path):
    text = path.read_text(encoding="utf-8")
    assert not re.search(r"https?://|git\+|[\"' =](/work/|/tmp/|/home/|/root/|/opt/)", text)


def test_every_pin_has_a_version_and_hashes():
    text = (ROOT / "envs/requirements.txt").read_text().replace("\\\n", " ")
    pins = [line for line in text.splitlines() if line and not line.lstrip().startswith("#")]
    assert len(pins) > 50
    assert all(re.match(r"^[A-Za-z0-9_.-]+==\S+( +--hash=sha256:[0-9a-f]{64})+ *$", pin) for pin in pins)


def test_every_direct_dependency_is_pinned():
    def canonical(name):
        return re.sub(r"[-_.]+", "-", re.match(r"[A-Za-z0-9_.-]+", name)[0]).lower()

    direct = [line for line in (ROOT / "envs/requirements.in").read_text().splitlines() if line[:1].isalpha()]
    pinned = re.findall(r"^([A-Za-z0-9_.-]+)==", (ROOT / "envs/requirements.txt").read_text(), re.MULTILINE)
    assert {canonical(name) for name in direct} <= {canonical(name) for name in pinned}


@pytest.mark.skipif(shutil.which("make") is None, reason="make is not installed")
@pytest.mark.parametrize(
    ("target", "commands"),
    [
        ("demo", ["snakemake --cores 2"]),
        ("test", ["ruff check", "ruff format --check", "snakefmt --check", "pytest"]),
    ],
)
def test_make_sets_up_from_hashes_and_runs(target, commands, tmp_path):
    for name in ("Makefile", "pyproject.toml", "envs/requirements.txt"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    plan = subprocess.run(["make", "-n", target], cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    assert "--require-hashes" in plan and "--no-deps" in plan
    assert all(command in plan for command in commands)


def test_no_kernel_lets_the_compiler_reorder_sums():
    """Sums whose order is free come out otherwise when a kernel is compiled than when it is loaded."""
    kernels = [path for path in sorted((ROOT / "src").rglob("*.py")) if "njit" in path.read_text(encoding="utf-8")]
    assert len(kernels) > 10
    assert not [path.name for path in kernels if "fastmath" in path.read_text(encoding="utf-8")]
