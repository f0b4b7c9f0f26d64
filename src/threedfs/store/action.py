"""What a job is to do, and the name of it in the store: known before any of it is done."""

from __future__ import annotations

import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from threedfs.params.schema import find_params, make_params
from threedfs.store.code import digest_code, library_versions
from threedfs.store.digests import InputDigests, digest_value

Inputs = Mapping[str, Path | list[Path] | None]


@dataclass(frozen=True)
class Task:
    """One stage's work on given files.

    Attributes
    ----------
    stage : str
        Name of a module of ``<package>.stages`` with a ``run``.
    inputs : mapping of str to Path, list of Path, or None
        A path may be a file or a folder; None is an optional input that is absent.
    outputs : mapping of str to Path
        Files, or folders if the stage makes folders.
    settings : mapping
        Every parameter of the stage.
    wildcards : mapping of str to JSON values
        What tells this job from others of its stage; given to the stage too.
    seed : int
    modules : sequence of str
        Full names of the modules that the stage loads by name; they count as its code.
    package : str
        Where stages are looked up.
    """

    stage: str
    inputs: Inputs
    outputs: Mapping[str, Path]
    settings: Mapping[str, Any] = field(default_factory=dict)
    wildcards: Mapping[str, Any] = field(default_factory=dict)
    seed: int = 0
    modules: Sequence[str] = ()
    package: str = "threedfs"

    @property
    def module(self) -> str:
        """Full name of the stage's module."""
        return f"{self.package}.stages.{self.stage}"


@dataclass(frozen=True)
class Action:
    """A task that is identified.

    Attributes
    ----------
    task : Task
    source : mapping
        What its outputs are made from: stage, parameters, seed, wildcards and digests of the inputs.
    maker : mapping
        What makes them, as `identify_maker` tells.
    params : object or None
        The stage's parameters.
    """

    task: Task
    source: Mapping[str, Any]
    maker: Mapping[str, Any]
    params: Any

    @property
    def key(self) -> str:
        """The name of the action in the store."""
        return digest_value({**self.source, **self.maker})

    @property
    def header(self) -> dict[str, Any]:
        """What goes into every artifact; without the code, so that an edit that changes no result changes no byte."""
        return {"parameters": self.source["parameters"], "provenance": digest_value(self.source)}


def identify(task: Task, digests: InputDigests) -> Action:
    """Find the key of a task: the digest of all that its result depends on.

    That is: stage, code, parameters, seed, wildcards, content of the inputs, versions of the libraries that the code
    imports. Threads, paths and the name of the sequence do not enter it. No stage is imported.

    Raises
    ------
    UserError
        If an input is missing.
    """
    declared = find_params(task.stage, task.package)
    params = None if declared is None else make_params(declared, task.settings)
    source = {
        "stage": task.stage,
        "parameters": _plain(params),
        "seed": task.seed,
        "wildcards": dict(task.wildcards),
        "inputs": digests.inputs(task.inputs, task.wildcards.get("keyframe")),
    }
    return Action(task, source, identify_maker(task.module, task.modules), params)


def identify_maker(module: str, modules: Sequence[str] = ()) -> dict[str, Any]:
    """Return what makes a stage's outputs: the digest of its code, and the versions of the libraries it imports."""
    code = digest_code(module, *modules)
    python = ".".join(platform.python_version_tuple()[:2])
    return {"code": code.digest, "versions": {"python": python, **library_versions(code.libraries)}}


def _plain(params: Any) -> dict[str, Any]:
    """Return parameters as plain values, or an empty mapping for a stage without any."""
    if params is None:
        return {}
    values = {name: getattr(params, name) for name in params.__dataclass_fields__}
    return {name: list(value) if isinstance(value, tuple) else value for name, value in values.items()}
