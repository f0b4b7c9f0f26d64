"""Contract: the package carries the workflow, and declares what it needs."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
DEVELOPMENT = {"setuptools", "mypy", "pytest", "ruff", "snakefmt"}


def name_of(requirement: str) -> str:
    return re.split(r"[<>=!~ ]", requirement)[0]


def test_dependencies_are_those_that_are_pinned():
    lines = (ROOT / "envs/requirements.in").read_text().splitlines()
    wanted = [line.partition("#")[0].strip() for line in lines]
    assert sorted(PROJECT["dependencies"]) == sorted(
        line for line in wanted if line and name_of(line) not in DEVELOPMENT
    )


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """The names of a wheel's files, built from a copy, as building leaves folders behind."""
    folder = tmp_path_factory.mktemp("wheel")
    for name in ("src", "workflow", "config", "profiles", "envs", "resources"):
        shutil.copytree(ROOT / name, folder / "copy" / name, ignore=shutil.ignore_patterns("__pycache__", "*.egg-info"))
    for name in ("Snakefile", "pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, folder / "copy")
    build = "-m pip wheel --quiet --no-deps --no-build-isolation --no-index ."
    subprocess.run(
        [sys.executable, *build.split(), "--wheel-dir", str(folder)],
        cwd=folder / "copy",
        check=True,
        capture_output=True,
    )
    (path,) = folder.glob("*.whl")
    return set(zipfile.ZipFile(path).namelist())


def test_the_wheel_holds_all_that_a_run_reads(wheel):
    carried = {name.partition("/data/share/threedfs/")[2] for name in wheel if "/data/share/threedfs/" in name}
    folders = ("workflow", "config", "profiles", "envs", "resources")
    needed = {
        path.relative_to(ROOT).as_posix()
        for folder in folders
        for path in (ROOT / folder).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    assert carried == needed | {"Snakefile"}
    assert "threedfs/cli/main.py" in wheel
    assert any(name.endswith("entry_points.txt") for name in wheel)
    assert any(name.endswith("licenses/LICENSE") for name in wheel)
