"""What a stage takes, read from its source, and inputs in the form in which it takes them."""

from __future__ import annotations

import ast
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path

from threedfs.store.action import Inputs
from threedfs.store.code import find_source

SUFFIX = ".zarr.zip"
"""Of the one file that a folder by keyframes holds for each: KEYFRAME.zarr.zip."""


def read_arguments(module: str) -> dict[str, str]:
    """Return the names of what a stage's `run` takes with their annotations; the module is read, not imported."""
    path = find_source(module)
    stamp = path.stat()
    return _read_run(path, stamp.st_mtime_ns, stamp.st_size)


def fit_inputs(
    arguments: Mapping[str, str], inputs: Inputs, keyframe: str | None = None, order: Sequence[str] | None = None
) -> Inputs:
    """Give of folders that hold a file for each keyframe what the stage takes: all of the files, or the keyframe's.

    Parameters
    ----------
    arguments : mapping of str to str
        Annotations by name: ``list[Path]`` means all files, ``Path`` that of the keyframe, or the folder as it is for
        a stage that is not about one.
    inputs : mapping
        Those that the stage does not take are left out.
    keyframe : str or None
        The one that the stage is to work on.
    order : sequence of str or None
        Of all keyframes; without it, files come in the order of their names.
    """

    def fit(name: str, value: Path | list[Path] | None) -> Path | list[Path] | None:
        if not isinstance(value, Path) or not value.is_dir():
            return value
        if "list[Path]" in arguments[name]:
            files = sorted(value.glob(f"*{SUFFIX}")) if order is None else [value / f"{one}{SUFFIX}" for one in order]
            return files or None
        by_keyframes = keyframe is not None and any(value.glob(f"*{SUFFIX}"))
        return value / f"{keyframe}{SUFFIX}" if by_keyframes else value

    return {name: fit(name, value) for name, value in inputs.items() if name in arguments}


@lru_cache(maxsize=64)
def _read_run(path: Path, _mtime_ns: int, _size: int) -> dict[str, str]:
    """Read a stage's file; the stamp makes the cache notice edits."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    (run,) = (node for node in tree.body if isinstance(node, ast.FunctionDef) and node.name == "run")
    return {one.arg: ast.unparse(one.annotation) if one.annotation else "" for one in run.args.kwonlyargs}
