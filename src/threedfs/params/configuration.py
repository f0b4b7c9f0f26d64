"""The configuration as a whole: its schema, and what is wrong with it in one sentence."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import jsonschema

from threedfs.errors import UserError
from threedfs.params.rendered import RENDERED_KEYS
from threedfs.params.schema import declared_stages, make_params, stage_schema
from threedfs.params.sizes import SCALE_SCHEMA

METHODS = (
    "fused_sdf",
    "deformed_sdf",
    "volumetric_gc",
    "gc_2d",
    "gc_2d3d_pixel",
    "gc_2d3d_voxel",
    "gc_select",
    "sdf_2d3d_voxel",
    "surface",
    "tsdf",
    "soft_maximum",
    "hard_maximum",
    "poisson",
)
MESH_METHODS = (
    *("surface", "sdf_2d3d_voxel", "gc_select", "gc_2d3d_voxel", "volumetric_gc", "deformed_sdf", "fused_sdf"),
    *("tsdf", "soft_maximum", "hard_maximum", "poisson"),
)
"""Methods with a mesh; the first that was run has the one to look at."""
JOINT_METHODS = ("gc_2d3d_pixel", "gc_2d3d_voxel", "gc_select", "sdf_2d3d_voxel", "surface")
"""Methods that take the object from the joint segmentation: those that have variants."""
VARIED_STAGES = ("segment", "cut_object", "surface")
"""What a variant of them may change."""
NAMES_OF_SEQUENCES = ("sequences", "cylinder_sequences")
"""Parameters that name sequences, and mean nothing for a single one."""
SEQUENCE_NAME = r"^[A-Za-z0-9_][A-Za-z0-9_.-]*$"

_PATH = {"type": ["string", "null"]}
_KINDS = {"array": "a list", "object": "keys with values"}
_HINTS = {
    "array": "; write a list, as in [{}]",
    "object": "; write its keys, as in {{key: value}}, in a file of your own and give it by --configfile",
}
_DATASET = {"type": "string", "pattern": SEQUENCE_NAME}


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
        "properties": {
            "source": _PATH,
            "dataset": _DATASET,
            **RENDERED_KEYS,
            "cameras": _PATH,
            "intrinsics": {**_numbers(4), "type": ["array", "null"]},
            "calibration": _PATH,
            "scale": SCALE_SCHEMA,
            "object": {"type": "boolean"},
            "truth": {"type": ["object", "null"], "additionalProperties": False, "properties": truth},
            "settings": {
                "type": "object",
                "additionalProperties": False,
                "properties": {stage: {"type": "object"} for stage in declared_stages()},
            },
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
        "skip_absent": {"type": "boolean"},
        "methods": {"type": "array", "minItems": 1, "uniqueItems": True, "items": {"enum": [*METHODS]}},
        "variants": {
            "type": ["object", "null"],
            "propertyNames": {"pattern": SEQUENCE_NAME},
            "additionalProperties": {
                "type": "object",
                "additionalProperties": False,
                "properties": {stage: {"type": "object"} for stage in VARIED_STAGES},
            },
        },
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
    _check_against(schema, config)
    for stage, declared in declared_stages().items():
        make_params(declared, config[stage])
    for name, entry in (config["sequences"] or {}).items():
        for stage, own in (entry.get("settings") or {}).items():
            where = f"sequences.{name}.settings.{stage}"
            if set(own) & set(NAMES_OF_SEQUENCES):
                raise UserError(f"configuration, {where}: expected no names of sequences; give them under {stage}.")
            _check_changes(config, schema, stage, own, where)
    variants = config["variants"] or {}
    if variants and not set(config["methods"]) & set(JOINT_METHODS):
        raise UserError(
            f"configuration, variants: expected a method that has variants, one of {', '.join(JOINT_METHODS)}, "
            f"found {', '.join(config['methods'])}; add one to methods."
        )
    for name, stages in variants.items():
        for stage, own in stages.items():
            _check_changes(config, schema, stage, own, f"variants.{name}.{stage}")


def _check_changes(
    config: Mapping[str, Any], schema: Mapping[str, Any], stage: str, own: Mapping[str, Any], where: str
) -> None:
    changed = {**config[stage], **own}
    _check_against(schema["properties"][stage], changed, where)
    make_params(declared_stages()[stage], changed)


def _check_against(schema: Mapping[str, Any], values: Mapping[str, Any], where: str = "") -> None:
    faults = jsonschema.Draft202012Validator(schema).iter_errors(values)
    fault = min(faults, key=lambda fault: [str(part) for part in fault.absolute_path], default=None)
    if fault is not None:
        raise UserError(_explain(fault, where))


def _explain(fault: jsonschema.ValidationError, start: str) -> str:
    """Say in one sentence where a configuration is wrong, what was expected and what came."""
    path = ".".join([*([start] if start else []), *(str(part) for part in fault.absolute_path)])
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
            kinds = [limit] if isinstance(limit, str) else limit
            expected = " or ".join(_KINDS.get(kind, kind) for kind in kinds)
            hint = next((_HINTS[kind] for kind in kinds if kind in _HINTS), "") if isinstance(value, str) else ""
            return f"{where}: expected {expected}, got {value!r}{hint.format(value)}."
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
            return explain_name(str(value), where, "variant" if path.startswith("variants") else "sequence")
        case _:
            return f"{where}: {fault.message}; see config/README.md."


def explain_name(name: str, where: str, what: str = "sequence") -> str:
    """Say why a name cannot name a sequence, or what else it is to name, and where it stands."""
    return (
        f"{name!r} cannot name a {what}: expected letters, digits, dots, dashes and underscores only, "
        f"because results are put in a folder of that name (in {where})."
    )
