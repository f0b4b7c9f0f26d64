"""The identity of a stage's code: what it would compute, not how its source is laid out."""

from __future__ import annotations

import ast
import hashlib
import importlib.util
from dataclasses import dataclass
from functools import lru_cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

_DISTRIBUTIONS = {
    "cv2": ("opencv-python-headless",),
    "maxflow": ("PyMaxflow",),
    "pycolmap": ("pycolmap", "pycolmap-cuda12"),
    "skimage": ("scikit-image",),
    "sklearn": ("scikit-learn",),
}
"""What brings a library, by import name: the pinned package first, then others that may stand in for it."""


@dataclass(frozen=True)
class Code:
    """What a module runs on.

    Attributes
    ----------
    digest : str
        SHA-256 over the syntax trees of the modules and of those of their package that they import, transitively.
    libraries : tuple of str
        Top-level names of everything else that these import, sorted; the standard library included.
    """

    digest: str
    libraries: tuple[str, ...]


def digest_code(module: str, *more: str) -> Code:
    """Find the modules that `module` runs on and digest them.

    Comments, docstrings, blank lines and line breaks do not count; imports inside functions do.

    Parameters
    ----------
    module : str
        e.g. ``"threedfs.stages.depth"``; it is read, not imported.
    *more : str
        Modules of the same package that it loads by name, which its source does not tell.

    Raises
    ------
    ModuleNotFoundError
        If there is no such module.
    """
    package = module.partition(".")[0]
    root = _package_folder(package)
    found, pending, libraries = {}, set(), set()
    for start in (module, *more):
        find_source(start)
        pending |= _with_parents(start)
    while pending:
        name = pending.pop()
        path = _source_file(root, name)
        if path is None:  # a name imported from a module, not a module
            continue
        stamp = path.stat()
        found[name], imports = _read_module(path, name, stamp.st_mtime_ns, stamp.st_size)
        for imported in imports:
            if imported == package or imported.startswith(package + "."):
                pending |= {parent for parent in _with_parents(imported) if parent not in found}
            else:
                libraries.add(imported.partition(".")[0])
    text = "\n".join(f"{name} {found[name]}" for name in sorted(found))
    return Code(hashlib.sha256(text.encode()).hexdigest(), tuple(sorted(libraries)))


def find_source(module: str) -> Path:
    """Return the file of a module, without importing it.

    Raises
    ------
    ModuleNotFoundError
        If there is no such module.
    """
    root = _package_folder(module.partition(".")[0])
    path = _source_file(root, module)
    if path is None:
        raise ModuleNotFoundError(f"no module named {module} under {root}")
    return path


@lru_cache(maxsize=256)
def library_versions(libraries: tuple[str, ...]) -> dict[str, str]:
    """Look up the installed versions of libraries by import name; the standard library has none.

    That of a package which stands in for the pinned one is followed by its name: it may compute otherwise.
    """
    versions = {}
    for library in libraries:
        names = _DISTRIBUTIONS.get(library, (library,))
        installed = [(name, number) for name in names if (number := _find_version(name))]
        if installed:
            name, number = installed[0]
            versions[library] = number if name == names[0] else f"{number} ({name})"
    return versions


def _find_version(distribution: str) -> str | None:
    try:
        return version(distribution)
    except PackageNotFoundError:
        return None


@lru_cache(maxsize=16)
def _package_folder(package: str) -> Path:
    specification = importlib.util.find_spec(package)
    if specification is None or specification.origin is None:
        raise ModuleNotFoundError(f"no package named {package}")
    return Path(specification.origin).parent


def _source_file(root: Path, module: str) -> Path | None:
    path = root.joinpath(*module.split(".")[1:])
    if (path / "__init__.py").is_file():
        return path / "__init__.py"
    source = path.with_suffix(".py")
    return source if path != root and source.is_file() else None


@lru_cache(maxsize=1024)
def _read_module(path: Path, module: str, _mtime_ns: int, _size: int) -> tuple[str, frozenset[str]]:
    """Digest one module and list all that it imports; the stamp makes the cache notice edits."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    package = module if path.name == "__init__.py" else module.rpartition(".")[0]
    imports = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            imports |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            origin = _resolve(node, package)
            imports |= {origin, *(f"{origin}.{alias.name}" for alias in node.names)}
        elif isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)):
            if ast.get_docstring(node, clean=False) is not None:
                node.body = node.body[1:]
    dump = ast.dump(tree, include_attributes=False)
    return hashlib.sha256(dump.encode()).hexdigest(), frozenset(imports)


def _resolve(node: ast.ImportFrom, package: str) -> str:
    if not node.level:
        return node.module or ""
    parts = package.split(".")
    base = ".".join(parts[: len(parts) - node.level + 1])
    return f"{base}.{node.module}" if node.module else base


def _with_parents(module: str) -> set[str]:
    """Return the module and the packages around it, whose ``__init__`` an import runs too."""
    parts = module.split(".")
    return {".".join(parts[:count]) for count in range(1, len(parts) + 1)}
