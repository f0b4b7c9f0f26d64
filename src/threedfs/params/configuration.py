"""The configuration as a whole: its schema, and what is wrong with it in one sentence."""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterator, Mapping
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
    "spectral_matting",
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
LONGEST_NAME = 100
"""Letters of a name: file systems allow 255, and methods, endings and marks of unfinished files are added to it."""
SEQUENCE_NAME = rf"^[A-Za-z0-9_][A-Za-z0-9_.-]{{0,{LONGEST_NAME - 1}}}(?!\n)$"
LARGEST_INTEGER = 2**31 - 1
"""What the libraries below take as a whole number, and as a seed."""

_DEEPEST = 20
_WIDEST_RENDER = 8192

_PATH = {"type": ["string", "null"]}
_KINDS = {"array": "a list", "object": "keys with values"}
_HINTS = {
    "array": "; write a list, as in [{}]",
    "object": "; write its keys, as in {{key: value}}, in a file of your own and give it by --configfile",
}
_DATASET = {"type": "string", "pattern": SEQUENCE_NAME}


def configuration_schema() -> dict[str, Any]:
    """Return the JSON schema of the configuration."""
    truth: dict[str, Any] = {name: _PATH for name in ("masks", "cameras", "mesh", "depth")}
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
            "keyframes_at_truth": {"type": "boolean"},
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
        "keyframes_at_truth": {"type": "boolean"},
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
        "seed": {"type": "integer", "minimum": 0, "maximum": LARGEST_INTEGER},
        "store": {"type": "string", "minLength": 1},
        "store_fallback": _PATH,
    }
    stages = {stage: stage_schema(declared) for stage, declared in declared_stages().items()}
    # not declared with the parameter: an edit of its file would film all sequences anew
    stages["render"]["properties"]["width"]["maximum"] = _WIDEST_RENDER
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
    _check_plain(config)
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


def _check_plain(value: Any, path: tuple[str, ...] = ()) -> None:
    """Refuse what YAML can write and no parameter can be, before a schema is asked: it compares and sorts keys."""
    where = f"configuration, {'.'.join(path)}" if path else "configuration"
    if len(path) > _DEEPEST:
        raise UserError(f"{where[:80]}...: expected at most {_DEEPEST} levels of keys, got more; see config/README.md.")
    for key, item in _list_items(value):
        if not isinstance(key, str):
            told = str(key).lower() if isinstance(key, bool) else "null" if key is None else str(key)
            raise UserError(
                f"{where}: expected a name, got {told}, which YAML reads as another kind of value; put it in quotes, "
                f"as '{told}'."
            )
        _check_plain(item, (*path, key))
    if isinstance(value, float) and not math.isfinite(value):
        raise UserError(f"{where}: expected a finite number, got {value}.")
    if isinstance(value, int) and abs(value) > LARGEST_INTEGER:
        digits = int(math.log10(abs(value))) + 1
        raise UserError(f"{where}: expected a whole number up to {LARGEST_INTEGER}, got one of {digits} digits.")


def _list_items(value: Any) -> Iterator[tuple[Any, Any]]:
    if isinstance(value, Mapping):
        yield from value.items()
    elif isinstance(value, (list, tuple)):
        yield from ((str(number), item) for number, item in enumerate(value))


def _is_integer(checker: Any, value: Any) -> bool:
    """Say whether a value is a whole number; JSON Schema takes 5.0 for one, and Python does not count to 5.0."""
    return isinstance(value, int) and not isinstance(value, bool)


_Validator = jsonschema.validators.extend(
    jsonschema.Draft202012Validator,
    type_checker=jsonschema.Draft202012Validator.TYPE_CHECKER.redefine("integer", _is_integer),
)


def _check_against(schema: Mapping[str, Any], values: Mapping[str, Any], where: str = "") -> None:
    faults = _Validator(schema).iter_errors(values)
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
            unknown = sorted(map(str, set(value) - set(fault.schema["properties"])))
            return f"{where}: unknown key {', '.join(unknown)}; {_suggest_key(unknown[0], fault.schema['properties'])}"
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
            return explain_name(str(value), where, _named_by(path))
        case _:
            return f"{where}: {fault.message}; see config/README.md."


def _suggest_key(unknown: str, known: Mapping[str, Any]) -> str:
    """Say which key may have been meant, where a key of that name is, or else which keys there are."""
    owners = [name for name, schema in known.items() if unknown in schema.get("properties", {})]
    near = difflib.get_close_matches(unknown, known, n=1)
    if owners:
        return f"it is a key of {', '.join(owners)}."
    return f"did you mean {near[0]}?" if near else f"the keys here are {', '.join(sorted(known))}."


def _named_by(path: str) -> str:
    """Return what the value at a place of the configuration is the name of."""
    if path.rpartition(".")[2] == "dataset":
        return "data set"
    return "variant" if path.startswith("variants") else "sequence"


def explain_name(name: str, where: str, what: str = "sequence") -> str:
    """Say why a name cannot name a sequence, or what else it is to name, and where it stands."""
    reason = "plots have it in their files' names" if what == "data set" else "results are put in a folder of that name"
    return (
        f"{_shorten(name)!r} cannot name a {what}: expected letters, digits, dots, dashes and underscores only, at "
        f"most {LONGEST_NAME}, because {reason} (in {_shorten(where, 200)})."
    )


def _shorten(text: str, longest: int = 60) -> str:
    return text if len(text) <= longest else f"{text[:longest]}..."
