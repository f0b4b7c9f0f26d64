"""What a configuration changes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from threedfs.params.schema import declared_stages, default_settings


def list_changes(config: Mapping[str, Any], own: Mapping[str, Mapping[str, Any]]) -> dict[str, str]:
    """Return the parameters of stages that differ from their defaults, `STAGE.KEY`, with their values.

    Parameters
    ----------
    config : mapping
        Of the run.
    own : mapping
        What a sequence changes of it, by stage.

    Examples
    --------
    >>> list_changes({"depth": {"iterations": 5}}, {"crops": {"whole": True}})
    {'crops.whole': 'True', 'depth.iterations': '5'}
    """
    changes = {}
    for stage, declared in declared_stages().items():
        defaults = default_settings(declared)
        for key, value in {**config.get(stage, {}), **own.get(stage, {})}.items():
            if value != defaults.get(key):
                changes[f"{stage}.{key}"] = str(value)
    return changes
