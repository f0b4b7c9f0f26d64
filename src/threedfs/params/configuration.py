"""The configuration as a whole: its schema, what is wrong with it in one sentence, and its sequences."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TextIO

import jsonschema

from threedfs.errors import UserError
from threedfs.params.schema import declared_stages, make_params, stage_schema

METHODS = ("fused_sdf",)
SEQUENCE_NAME = r"^[A-Za-z0-9_][A-Za-z0-9_.-]*$"
SEQUENCE_FILES = ("source", "cameras", "calibration", "truth_masks", "truth_cameras", "truth_mesh", "truth_depth")
"""What a sequence's entry names: files and folders that must be there."""

_PATH = {"type": ["string", "null"]}
_DEPTH_SCALE = 1000.0


def configuration_schema() -> dict[str, Any]:
    """Return the JSON schema of the configuration."""
    truth = {name: _PATH for name in ("masks", "cameras", "mesh", "depth")}
    truth["depth_scale"] = {"type": "number", "exclusiveMinimum": 0}
    truth["depth_camera"] = {
        "type": ["object", "null"],
        "additionalProperties": False,
        "required": ["intrinsics", "offset"],
        "properties": {"intrinsics": _numbers(4), "offset": _numbers(3)},
    }
    sequence = {
        "type": "object",
        "additionalProperties": False,
        "required": ["source"],
        "properties": {
            "source": {"type": "string"},
            "cameras": _PATH,
            "intrinsics": {**_numbers(4), "type": ["array", "null"]},
            "calibration": _PATH,
            "object": {"type": "boolean"},
            "truth": {"type": ["object", "null"], "additionalProperties": False, "properties": truth},
        },
    }
    general = {
        "dataset": {"type": "string", "pattern": SEQUENCE_NAME},
        "video": _PATH,
        "sequences": {
            "type": ["object", "null"],
            "additionalProperties": sequence,
            "propertyNames": {"pattern": SEQUENCE_NAME},
        },
        "skip_absent": {"type": "boolean"},
        "methods": {"type": "array", "minItems": 1, "uniqueItems": True, "items": {"enum": [*METHODS]}},
        "seed": {"type": "integer", "minimum": 0},
        "store": {"type": "string", "minLength": 1},
    }
    stages = {stage: stage_schema(declared) for stage, declared in declared_stages().items()}
    return {
        "type": "object",
        "additionalProperties": False,
        "required": [*general, *stages],
        "properties": {**general, **stages},
    }


def _numbers(count: int) -> dict[str, Any]:
    return {"type": "array", "items": {"type": "number"}, "minItems": count, "maxItems": count}


def check_configuration(config: Mapping[str, Any], schema: Mapping[str, Any]) -> None:
    """Check a configuration against the schema, and each stage's parameters against each other.

    Raises
    ------
    UserError
        For the first fault, in the order of the keys; values that do not fit each other come last.
    """
    faults = jsonschema.Draft202012Validator(schema).iter_errors(config)
    fault = min(faults, key=lambda fault: [str(part) for part in fault.absolute_path], default=None)
    if fault is not None:
        raise UserError(_explain(fault))
    for stage, declared in declared_stages().items():
        make_params(declared, config[stage])


def load_sequences(config: Mapping[str, Any], home: Path, notes: TextIO | None = None) -> dict[str, dict[str, Any]]:
    """Check the configuration and return its sequences, as `check_configuration` and `list_sequences` do.

    Each sequence says too whether it takes part in the depth experiment.

    Parameters
    ----------
    config, home
        As `list_sequences` takes them.
    notes : text stream, optional
        Gets a line for each sequence that is skipped.

    Raises
    ------
    UserError
        If also the depth experiment names a sequence that cannot take part, or nothing is to be done with one.
    """
    check_configuration(config, configuration_schema())
    sequences = list_sequences(config, home, lambda sentence: notes and notes.write(f"threedfs: {sentence}\n"))
    tried = config["depth_experiment"]["sequences"]
    _check_tried([name for name in tried if name not in (config["sequences"] or {})], sequences, tried)
    return {name: {**entry, "depth_experiment": name in tried} for name, entry in sequences.items()}


def list_sequences(
    config: Mapping[str, Any], home: Path, note: Callable[[str], Any] = lambda sentence: None
) -> dict[str, dict[str, Any]]:
    """Return the sequences to work on, by name.

    Without `video` or `sequences` that is the sample which ships with the project. Relative paths count from the
    working directory, the sample's from `home`.

    Parameters
    ----------
    config : mapping
    home : Path
        Folder of the project.
    note : callable
        Takes a sentence for each sequence that is skipped because its source is absent (`skip_absent`).

    Returns
    -------
    dict of str to dict
        `SEQUENCE_FILES`: paths or None; intrinsics: list of float or None; object: bool; depth_scale: float;
        depth_camera: dict or None.

    Raises
    ------
    UserError
        If a name cannot name a folder, a path leads nowhere, or no sequence is left.
    """
    given = dict(config["sequences"] or {})
    if config["video"]:
        if not os.path.exists(config["video"]):
            raise UserError(f"video: expected a video file or a folder of photos, found no {config['video']}.")
        name = Path(config["video"]).stem
        if not re.match(SEQUENCE_NAME, name):
            raise UserError(_explain_name(name, f"the file {config['video']}; rename it, or list it under sequences"))
        given = {name: {"source": config["video"]}}
    sequences = {name: _flatten(entry) for name, entry in given.items()} or {"sample": _sample(home)}
    if config["skip_absent"]:
        sequences = _skip_absent(sequences, note)
    for name, entry in sequences.items():
        for key in SEQUENCE_FILES:
            if entry[key] is not None and not os.path.exists(entry[key]):
                where = f"sequences.{name}.{key.replace('truth_', 'truth.')}"
                raise UserError(f"{where}: expected a file or folder, found no {entry[key]} in {os.getcwd()}.")
    return sequences


def _check_tried(unknown: list[str], sequences: Mapping[str, dict[str, Any]], tried: list[str]) -> None:
    if unknown:
        raise UserError(
            f"depth_experiment.sequences: expected names of sequences, got {', '.join(unknown)}, which is none of them."
        )
    for name, entry in sequences.items():
        missing = [key for key in ("cameras", "truth_cameras", "truth_depth") if entry[key] is None]
        if name in tried and missing:
            raise UserError(
                f"depth_experiment.sequences: expected given cameras and true depth of {name}, found no "
                f"{' and no '.join(missing).replace('truth_', 'truth.')}; give them under sequences.{name}."
            )
        if name not in tried and not entry["object"]:
            raise UserError(
                f"sequences.{name}: expected its name in depth_experiment.sequences, as object: false leaves nothing "
                "else to do, found it missing; add it there."
            )


def _skip_absent(sequences: Mapping[str, dict[str, Any]], note: Callable[[str], Any]) -> dict[str, dict[str, Any]]:
    present = {name: entry for name, entry in sequences.items() if os.path.exists(entry["source"])}
    if not present:
        raise UserError(
            f"sequences: expected at least one whose source is there, found none of the {len(sequences)} in "
            f"{os.getcwd()}, e.g. no {next(iter(sequences.values()))['source']}; get the data, or correct the paths."
        )
    for name in sequences:
        if name not in present:
            note(f"sequence {name} is skipped: its source {sequences[name]['source']} is not in {os.getcwd()}.")
    return present


def _sample(home: Path) -> dict[str, Any]:
    folder = home / "resources" / "sample"
    if folder.is_relative_to(os.getcwd()):
        folder = folder.relative_to(os.getcwd())
    truth = {"masks": "masks", "cameras": "cameras.json", "mesh": "mesh.ply"}
    return _flatten(
        {
            "source": str(folder / "video.mp4"),
            "truth": {name: str(folder / file) for name, file in truth.items()},
        }
    )


def _flatten(entry: Mapping[str, Any]) -> dict[str, Any]:
    truth = {f"truth_{key}": value for key, value in (entry.get("truth") or {}).items()}
    return {key: {**entry, **truth}.get(key) for key in SEQUENCE_FILES} | {
        "intrinsics": entry.get("intrinsics"),
        "object": entry.get("object", True),
        "depth_scale": truth.get("truth_depth_scale", _DEPTH_SCALE),
        "depth_camera": truth.get("truth_depth_camera"),
    }


def _explain(fault: jsonschema.ValidationError) -> str:
    """Say in one sentence where a configuration is wrong, what was expected and what came."""
    path = ".".join(str(part) for part in fault.absolute_path)
    where = f"configuration, {path}" if path else "configuration"
    limit, value = fault.validator_value, fault.instance
    match fault.validator:
        case "additionalProperties":
            unknown = sorted(set(value) - set(fault.schema["properties"]))
            known = ", ".join(sorted(fault.schema["properties"]))
            return f"{where}: unknown key {', '.join(unknown)}; the keys here are {known}."
        case "required":
            missing = sorted(set(limit) - set(value))
            return f"{where}: expected the key {', '.join(missing)}, found none; see config/README.md."
        case "type":
            expected = " or ".join([limit] if isinstance(limit, str) else limit)
            hint = "; give nested values in a file with --configfile" if isinstance(value, str) else ""
            return f"{where}: expected {expected}, got {value!r}{hint}."
        case "enum":
            return f"{where}: expected one of {', '.join(map(str, limit))}, got {value!r}."
        case "minimum":
            return f"{where}: expected at least {limit}, got {value}."
        case "maximum":
            return f"{where}: expected at most {limit}, got {value}."
        case "minItems" | "maxItems":
            bound = "least" if fault.validator == "minItems" else "most"
            return f"{where}: expected at {bound} {limit} values, got {len(value)}."
        case "exclusiveMinimum":
            return f"{where}: expected more than {limit}, got {value}."
        case "pattern":
            return _explain_name(str(value), where)
        case _:
            return f"{where}: {fault.message}; see config/README.md."


def _explain_name(name: str, where: str) -> str:
    return (
        f"{name!r} cannot name a sequence: expected letters, digits, dots, dashes and underscores only, "
        f"because results are put in a folder of that name (in {where})."
    )
