"""From the declared parameters to the configuration: defaults, schema, documentation; and back to dataclasses."""

from __future__ import annotations

import importlib
import importlib.util
import types
import typing
from collections.abc import Mapping
from dataclasses import Field, fields, is_dataclass
from functools import lru_cache
from typing import Any

STAGES = (
    "render",
    "calibrate",
    "frames",
    "features",
    "poses",
    "scale",
    "keyframes",
    "shrink",
    "crops",
    "semidense",
    "stereo",
    "stereo_check",
    "edges",
    "depth",
    "consistency",
    "fuse_scene",
    "locate",
    "fuse_object",
    "fuse_baseline",
    "locate_object",
    "densify",
    "deform",
    "superpixels",
    "segment",
    "spectral_matting",
    "volumetric_cut",
    "object",
    "cut_object",
    "surface",
    "texture",
    "poisson",
    "evaluate_reconstruction",
    "evaluate",
    "photographs",
    "depth_trial",
    "depth_experiment",
)
"""Every stage that may have parameters, in the order of the pipeline."""

_JSON_TYPES = {bool: "boolean", int: "integer", float: "number", str: "string", types.NoneType: "null"}


@lru_cache(maxsize=64)
def find_params(stage: str, package: str = "threedfs") -> type | None:
    """Return the dataclass that declares a stage's parameters, or None for a stage without any."""
    name = f"{package}.params.{stage}"
    if importlib.util.find_spec(name) is None:
        return None
    module = importlib.import_module(name)
    classes = (value for value in vars(module).values() if isinstance(value, type) and is_dataclass(value))
    own = (value for value in classes if value.__module__ == name)
    (found,) = (value for value in own if value.__name__.endswith("Params"))
    return found


def declared_stages() -> dict[str, type]:
    """Return the parameters' dataclass of every stage that has one, in the order of the pipeline."""
    found = ((stage, find_params(stage)) for stage in STAGES)
    return {stage: declared for stage, declared in found if declared is not None}


def make_params(declared: type, settings: Mapping[str, Any]) -> Any:
    """Make a stage's parameters from its section of the configuration.

    Whole numbers given for real ones become real, and lists tuples, so that equal settings are equal values.

    Parameters
    ----------
    declared : type
        The stage's dataclass.
    settings : mapping
        A value for every parameter.
    """
    return declared(**{name: _convert(hint, settings[name]) for name, hint in _hints(declared).items()})


def default_settings(declared: type) -> dict[str, Any]:
    """Return the defaults of a stage as plain values for YAML."""
    return {field.name: _plain(field.default) for field in fields(declared)}


def stage_schema(declared: type) -> dict[str, Any]:
    """Return the JSON schema of a stage's section: every parameter required, none unknown."""
    hints = _hints(declared)
    return {
        "type": "object",
        "additionalProperties": False,
        "required": [field.name for field in fields(declared)],
        "properties": {field.name: _field_schema(field, hints[field.name]) for field in fields(declared)},
    }


def _field_schema(field: Field, hint: Any) -> dict[str, Any]:
    schema = {"description": field.metadata["meaning"], **_type_schema(hint)}
    limits = {
        "minimum": field.metadata["minimum"],
        "maximum": field.metadata["maximum"],
        "exclusiveMinimum": field.metadata["exclusive_minimum"],
        "enum": field.metadata["choices"] and [*field.metadata["choices"]],
    }
    if "items" in schema and field.default:
        schema.setdefault("minItems", 1)  # a list that is not empty by default has a use only with values
    where = schema["items"] if "items" in schema else schema
    where.update({name: limit for name, limit in limits.items() if limit is not None})
    if "enum" in where and where is schema and types.NoneType in typing.get_args(hint):
        where["enum"].append(None)
    return schema


def _type_schema(hint: Any) -> dict[str, Any]:
    if typing.get_origin(hint) is tuple:
        items = typing.get_args(hint)
        if items[-1] is Ellipsis:
            return {"type": "array", "items": _type_schema(items[0])}
        return {"type": "array", "items": _type_schema(items[0]), "minItems": len(items), "maxItems": len(items)}
    if typing.get_origin(hint) in (types.UnionType, typing.Union):
        options = [_type_schema(option) for option in typing.get_args(hint)]
        merged = {key: value for option in options for key, value in option.items()}
        return {**merged, "type": [option["type"] for option in options]}
    return {"type": _JSON_TYPES[hint]}


def _hints(declared: type) -> dict[str, Any]:
    hints = typing.get_type_hints(declared)
    return {field.name: hints[field.name] for field in fields(declared)}


def _convert(hint: Any, value: Any) -> Any:
    if isinstance(value, (list, tuple)):
        (item, *_) = typing.get_args(next(h for h in _options(hint) if typing.get_origin(h) is tuple))
        return tuple(_convert(item, element) for element in value)
    if float in _options(hint) and int not in _options(hint) and isinstance(value, int) and not isinstance(value, bool):
        return float(value)
    return value


def _options(hint: Any) -> tuple[Any, ...]:
    return typing.get_args(hint) if typing.get_origin(hint) in (types.UnionType, typing.Union) else (hint,)


def _plain(value: Any) -> Any:
    return [_plain(item) for item in value] if isinstance(value, tuple) else value
