"""From a stage's parameters to the rule that a topic takes."""

from __future__ import annotations

import inspect
from typing import Any, TypeVar

Rule = TypeVar("Rule")


def make_rule(rule: type[Rule], params: Any, **given: Any) -> Rule:
    """Make a topic's rule out of the parameters that have the names of its fields.

    Parameters
    ----------
    rule : type
        A frozen dataclass or a named tuple.
    params : object
        The stage's parameters.
    **given
        Fields that have no parameter of their name, or that are not the parameter itself.

    Examples
    --------
    >>> from typing import NamedTuple
    >>> from threedfs.params.stereo_check import StereoCheckParams
    >>> class Limits(NamedTuple):
    ...     max_cost: float
    ...     angle: float
    >>> make_rule(Limits, StereoCheckParams(max_cost=0.2), angle=1.5)
    Limits(max_cost=0.2, angle=1.5)
    """
    names = inspect.signature(rule).parameters
    return rule(**{name: given[name] if name in given else getattr(params, name) for name in names})
