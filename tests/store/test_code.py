"""Property: the code digest follows what a stage would compute, and nothing else."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError

import pytest

from threedfs.store import code
from threedfs.store.code import digest_code, library_versions

MODULE = "toolbox.stages.join"


def edited(path, old, new):
    """Replace text in a source file."""
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("stages/join.py", '"""A stage that joins what it reads."""', '"""Reworded."""'),
        ("stages/join.py", '    """Write the parts, joined."""\n', ""),
        ("stages/join.py", "\n\n\n", "\n\n\n\n# a comment\n"),
        ("topic.py", "# in order", "# sorted"),
        ("unrelated.py", '"""Nothing imports this."""', "x = 1"),
    ],
)
def test_layout_and_unrelated_modules_do_not_count(toolbox, file, old, new):
    before = digest_code(MODULE).digest
    edited(toolbox / file, old, new)
    assert digest_code(MODULE).digest == before


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("stages/join.py", "str(names)", "repr(names)"),
        ("topic.py", '"+"', '"-"'),
        ("__init__.py", "", "x = 1\n"),
        ("stages/__init__.py", "", "x = 1\n"),
    ],
)
def test_code_that_the_stage_runs_counts(toolbox, file, old, new):
    before = digest_code(MODULE).digest
    edited(toolbox / file, old, new)
    assert digest_code(MODULE).digest != before


@pytest.mark.parametrize(
    "statement",
    [
        "import toolbox.unrelated",
        "from toolbox import unrelated",
        "from .. import unrelated",
        "def late():\n    from toolbox.unrelated import x",
    ],
)
def test_every_form_of_import_is_followed(toolbox, statement):
    with (toolbox / "stages" / "join.py").open("a") as file:
        file.write(f"\n{statement}\n")
    before = digest_code(MODULE).digest
    (toolbox / "unrelated.py").write_text("x = 2")
    assert digest_code(MODULE).digest != before


def test_libraries_are_those_imported(toolbox):
    edited(toolbox / "topic.py", '"""Joining."""', "import json\n\nimport numpy.linalg")
    libraries = digest_code(MODULE).libraries
    assert {"json", "numpy"} <= set(libraries)
    assert set(library_versions(libraries)) == {"numpy"}


@pytest.mark.parametrize(
    ("installed", "expected"),
    [
        ({"pycolmap": "4.2.1"}, {"pycolmap": "4.2.1"}),
        ({"pycolmap-cuda12": "4.2.1"}, {"pycolmap": "4.2.1 (pycolmap-cuda12)"}),
        ({}, {}),
    ],
)
def test_a_package_that_stands_in_for_a_pinned_one_is_told_from_it(monkeypatch, installed, expected):
    """Exact: COLMAP built with CUDA comes as another package, and what it computed is not taken for the other's."""

    def find(name):
        if name not in installed:
            raise PackageNotFoundError(name)
        return installed[name]

    monkeypatch.setattr(code, "version", find)
    library_versions.cache_clear()
    try:
        assert library_versions(("json", "pycolmap")) == expected
    finally:
        library_versions.cache_clear()


def test_unknown_module_is_refused(toolbox):
    with pytest.raises(ModuleNotFoundError, match=r"toolbox\.stages\.nothing"):
        digest_code("toolbox.stages.nothing")


def test_fusion_and_depth_do_not_share_their_digest():
    depth = digest_code("threedfs.stages.depth")
    fusion = digest_code("threedfs.stages.fuse_object")
    assert depth.digest != fusion.digest
    assert {"numpy", "numba", "cv2"} <= set(depth.libraries)
