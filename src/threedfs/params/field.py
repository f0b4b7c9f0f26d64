"""A parameter: its default, meaning, unit, place in the paper and range, declared once.

Each stage's parameters are a frozen dataclass of such fields in a module of its own, so that the code
digest of one stage does not change with another's parameters. The configuration's defaults, schema and
documentation are made from these declarations.
"""

from __future__ import annotations

from dataclasses import field
from typing import Any


def parameter(
    default: Any,
    meaning: str,
    *,
    unit: str = "",
    symbol: str = "",
    equation: str = "",
    minimum: float | None = None,
    maximum: float | None = None,
    exclusive_minimum: float | None = None,
    choices: tuple[str, ...] | None = None,
) -> Any:
    """Declare one parameter.

    Parameters
    ----------
    default : bool, int, float, str, None or tuple
    meaning : str
        One line for the user.
    unit : str
    symbol, equation : str
        The paper's letter and place, e.g. ``"lambda_c"``, ``"Eq. 4"``.
    minimum, maximum, exclusive_minimum : float, optional
        Range, ends included unless exclusive.
    choices : tuple of str, optional
        The values allowed.
    """
    metadata = {
        "meaning": meaning,
        "unit": unit,
        "symbol": symbol,
        "equation": equation,
        "minimum": minimum,
        "maximum": maximum,
        "exclusive_minimum": exclusive_minimum,
        "choices": choices,
    }
    return field(default=default, metadata=metadata)
