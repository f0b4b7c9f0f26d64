"""The configuration as a whole: its schema, what is wrong with it in one sentence, and its sequences."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import jsonschema

from threedfs.errors import UserError
from threedfs.params.rendered import RENDERED_KEYS, bring_render
from threedfs.params.schema import declared_stages, make_params, stage_schema

METHODS = ("fused_sdf",)
SEQUENCE_NAME = r"^[A-Za-z0-9_][A-Za-z0-9_.-]*$"
SEQUENCE_FILES = ("source", "cameras", "calibration", "truth_masks", "truth_cameras", "truth_mesh", "truth_depth")
"""What a sequence's entry names: files and folders that must be there."""

_PATH = {"type": ["string", "null"]}
_DATASET = {"type": "string", "pattern": SEQUENCE_NAME}


def configuration_schema() -> dict[str, Any]:
    """Return the JSON schema of the configuration."""
    truth = {name: _PATH for name in ("masks", "cameras", "mesh", "depth")}
    sequence = {
        "type": "object",
        "additionalProperties": False,
        "properties": {
            "source": _PATH,
            "dataset": _DATASET,
            **RENDERED_KEYS,
            "cameras": _PATH,
            "calibration": _PATH,
            "truth": {"type": ["object", "null"], "additionalProperties": False, "properties": truth},
        },
    }
    general = {
        "dataset": _DATASET,
        "video": _PATH,
        "sequences": {
            "type": ["object", "null"],
            "additionalProperties": sequence,
            "propertyNames": {"pattern": SEQUENCE_NAME},
        },
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


def list_sequences(config: Mapping[str, Any], home: Path) -> dict[str, dict[str, str | None]]:
    """Return the sequences to work on, by name.

    Without `video` or `sequences` that is the sample which ships with the project. Relative paths count from the
    working directory, the sample's from `home`.

    Returns
    -------
    dict of str to dict
        `SEQUENCE_FILES`: paths or None; dataset; rendered: the take that is filmed for the sequence, or None. The paths
        of a rendered sequence are results of the run.

    Raises
    ------
    UserError
        If a name cannot name a folder, the one video is not there, or it is not clear where the images come from.
    """
    given = dict(config["sequences"] or {})
    if config["video"]:
        if not os.path.exists(config["video"]):
            raise UserError(f"video: expected a video file or a folder of photos, found no {config['video']}.")
        name = Path(config["video"]).stem
        if not re.match(SEQUENCE_NAME, name):
            raise UserError(_explain_name(name, f"the file {config['video']}; rename it, or list it under sequences"))
        given = {name: {"source": config["video"]}}
    sequences = {name: _flatten(bring_render(name, entry)) for name, entry in given.items()}
    sequences = sequences or {"sample": _sample(home)}
    return {name: {"dataset": config["dataset"], **entry} for name, entry in sequences.items()}


def set_aside_missing(
    sequences: Mapping[str, Mapping[str, str | None]],
) -> tuple[dict[str, Mapping[str, str | None]], dict[str, str]]:
    """Find the sequences of which a file or folder is missing.

    Parameters
    ----------
    sequences : mapping
        From `list_sequences`.

    Returns
    -------
    sequences : dict
        The same; where one path leads nowhere, all paths are None.
    missing : dict of str to str
        For each of those a sentence about the first such path.
    """
    missing = {}
    for name, entry in sequences.items():
        for key in SEQUENCE_FILES:
            if entry["rendered"] is None and entry[key] is not None and not os.path.exists(entry[key]):
                where = f"sequences.{name}.{key.replace('truth_', 'truth.')}"
                missing.setdefault(name, f"{where}: expected a file or folder, found no {entry[key]} in {os.getcwd()}.")
    emptied = {name: {**sequences[name], **dict.fromkeys(SEQUENCE_FILES)} for name in missing}
    return {**sequences, **emptied}, missing


def _sample(home: Path) -> dict[str, str | None]:
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


def _flatten(entry: Mapping[str, Any]) -> dict[str, str | None]:
    truth = {f"truth_{key}": path for key, path in (entry.get("truth") or {}).items()}
    own = {"dataset": entry["dataset"]} if "dataset" in entry else {}
    return {key: {**entry, **truth}.get(key) for key in SEQUENCE_FILES} | {"rendered": entry.get("rendered")} | own


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
