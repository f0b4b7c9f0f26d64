"""Parameters of stages that are given on Snakemake's command line, as in `--config 'depth={iterations: 5}'`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import yaml


def read_scalars(config: dict[str, Any], given: Mapping[str, Any], schema: Mapping[str, Any]) -> None:
    """Turn text below the top level into the numbers that a parameter takes, where it takes no text.

    Snakemake reads what is one word on its command line as YAML does, but leaves everything inside of brackets text.

    Parameters
    ----------
    config : dict
        The configuration, changed in place.
    given : mapping
        What of it came by `--config`.
    schema : mapping
        That of the configuration.

    Examples
    --------
    >>> config = {"depth": {"iterations": "5", "prior": "1"}}
    >>> kinds = {"iterations": {"type": "integer"}, "prior": {"type": "string"}}
    >>> read_scalars(config, config, {"properties": {"depth": {"properties": kinds}}})
    >>> config
    {'depth': {'iterations': 5, 'prior': '1'}}
    """
    for key, value in given.items():
        if key in config and isinstance(value, (Mapping, list)):
            config[key] = _read(config[key], value, _below(schema, key))


def _read(value: Any, given: Any, schema: Mapping[str, Any]) -> Any:
    if isinstance(value, dict) and isinstance(given, Mapping):
        return {
            key: _read(item, given[key], _below(schema, key)) if key in given else item for key, item in value.items()
        }
    if isinstance(value, list):
        return [_read(item, item, schema.get("items", {})) for item in value]
    if not isinstance(value, str) or "string" in _types(schema):
        return value
    try:
        return yaml.safe_load(value)
    except (yaml.YAMLError, ValueError):
        return value


def _below(schema: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    """Return the schema of a key, or an empty one that says nothing."""
    found = schema.get("properties", {}).get(key, schema.get("additionalProperties"))
    return found if isinstance(found, Mapping) else {}


def _types(schema: Mapping[str, Any]) -> list[str]:
    kinds = schema.get("type", "string" if "enum" in schema else [])
    return [kinds] if isinstance(kinds, str) else list(kinds)
