"""Contract: imports point down only, and each guarded library has its one place."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

SOURCE = Path(__file__).resolve().parents[2] / "src"
MODULES = sorted((SOURCE / "threedfs").rglob("*.py"))
FILE_LAYERS = {"cli", "inputs", "io", "stages", "store", "params", "run_end", "synthetic"}
"""Parts of the package that know files, configuration or jobs; the others know arrays."""
FILES_MAY_BE_READ_BY = {"threedfs.frames", "threedfs.colmap"}
"""Topics that take the path of a source or of a library's own format: decoders and COLMAP."""


def name_of(path: Path) -> str:
    """Return a module's dotted name."""
    parts = path.relative_to(SOURCE).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imports_of(path: Path) -> set[str]:
    """Return all that a module imports, also inside functions: modules, and names of modules with a dot."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: a relative import"
            found |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    return found


def importers_of(library: str) -> set[str]:
    """Return the modules that import a library."""
    wanted = {path: {name.partition(".")[0] for name in imports_of(path)} for path in MODULES}
    return {name_of(path) for path, names in wanted.items() if library in names}


def topic_of(module: str) -> str:
    """Return the part of the package that a module belongs to."""
    return module.split(".")[1] if "." in module else ""


def test_nothing_in_the_package_knows_snakemake():
    assert importers_of("snakemake") == set()


def test_pycolmap_is_imported_in_one_folder():
    assert {module.rpartition(".")[0] for module in importers_of("pycolmap")} <= {"threedfs", "threedfs.colmap"}
    assert all(module.startswith("threedfs.colmap") for module in importers_of("pycolmap"))


def test_maxflow_is_imported_in_one_module_at_most():
    assert len(importers_of("maxflow")) <= 1


@pytest.mark.parametrize("path", MODULES, ids=name_of)
def test_a_topic_knows_neither_stages_nor_files_nor_parameters(path):
    module = name_of(path)
    if topic_of(module) in FILE_LAYERS | {""}:
        return
    above = ("threedfs.stages", "threedfs.params", "threedfs.store", "threedfs.job", "threedfs.run_end")
    found = {name for name in imports_of(path) if name.startswith(above)}
    if not module.startswith(tuple(FILES_MAY_BE_READ_BY)):
        found |= {name for name in imports_of(path) if name.startswith("threedfs.io")}
    assert not found, f"{module} imports {found}"


@pytest.mark.parametrize("path", [path for path in MODULES if topic_of(name_of(path)) == "stages"], ids=name_of)
def test_a_stage_does_not_import_another(path):
    own = name_of(path)
    assert not {n for n in imports_of(path) if n.startswith("threedfs.stages") and n not in ("threedfs.stages", own)}


@pytest.mark.parametrize("path", [path for path in MODULES if topic_of(name_of(path)) == "io"], ids=name_of)
def test_io_knows_no_stage_and_no_parameters(path):
    above = ("threedfs.stages", "threedfs.params", "threedfs.store", "threedfs.job")
    assert not {name for name in imports_of(path) if name.startswith(above)}


def test_geometry_stands_on_types_alone():
    for path in MODULES:
        if topic_of(name_of(path)) == "geometry":
            allowed = ("threedfs.geometry", "threedfs.types", "threedfs.errors", "threedfs.checks", "threedfs.threads")
            assert not {n for n in imports_of(path) if n.startswith("threedfs.") and not n.startswith(allowed)}


def test_deciding_on_a_hit_imports_no_numeric_library():
    pending, seen, libraries = {"threedfs.store.command"}, set(), set()
    while pending:
        module = pending.pop()
        seen.add(module)
        path = SOURCE / Path(*module.split("."))
        path = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
        if path.is_file():
            names = imports_of(path)
            libraries |= {name.partition(".")[0] for name in names}
            pending |= {name for name in names if name.startswith("threedfs")} - seen
    assert not libraries & {"numpy", "scipy", "numba", "cv2", "zarr", "pycolmap", "trimesh", "skimage"}
