"""Known lengths, from which the metric scale is found."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any

from threedfs.errors import UserError

_MILLIMETRES = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4, "": 1.0}
_LENGTH = {"type": ["string", "number"]}

SCALE_SCHEMA = {
    "type": ["object", "null"],
    "additionalProperties": False,
    "properties": {
        "tag": _LENGTH,
        "board": {
            "type": "object",
            "additionalProperties": False,
            "required": ["corners", "square"],
            "properties": {
                "corners": {"type": "array", "items": {"type": "integer", "minimum": 3}, "minItems": 2, "maxItems": 2},
                "square": _LENGTH,
            },
        },
        "height": _LENGTH,
    },
}
"""JSON schema of a sequence's `scale`."""


def read_length(text: str | float, where: str) -> float:
    """Return a length in millimetres, as in 95mm, 9.5cm, 0.095m, 3.7in; a bare number is millimetres.

    Parameters
    ----------
    text : str or float
    where : str
        What it is given by, for the message.

    Raises
    ------
    UserError
        If it is no positive length.

    Examples
    --------
    >>> read_length("9.5cm", "--height"), read_length(95, "--height")
    (95.0, 95.0)
    """
    match = re.fullmatch(r"\s*([0-9]*\.?[0-9]+(?:[eE][-+]?\d+)?)\s*(mm|cm|m|in|)\s*", str(text))
    length = float(match[1]) * _MILLIMETRES[match[2]] if match else 0.0
    if not 0 < length < math.inf:
        raise UserError(f"{where}: expected a length such as 95mm, 9.5cm or 0.095m, got {text!r}.")
    return length


def read_board(text: str) -> dict[str, Any]:
    """Return the entry of the configuration that a board such as 9x6:25mm stands for.

    Raises
    ------
    UserError
        If it is not of this form.

    Examples
    --------
    >>> read_board("9x6:25mm")
    {'corners': [9, 6], 'square': '25mm'}
    """
    match = re.fullmatch(r"\s*(\d+)\s*x\s*(\d+)\s*:(.+)", text)
    if match is None or min(int(match[1]), int(match[2])) < 3:
        raise UserError(
            "--board: expected inner corners along a row and a column, at least 3, and the side of a square, as in "
            f"9x6:25mm, got {text!r}."
        )
    read_length(match[3], "--board")
    return {"corners": [int(match[1]), int(match[2])], "square": match[3].strip()}


def read_scale_entry(entry: Mapping[str, Any] | None, where: str) -> dict[str, Any] | None:
    """Return what a sequence's `scale` says: `source`, `length` in metres and, of a board, `corners`; None without one.

    Raises
    ------
    UserError
        If it names not one source, or no positive length.
    """
    if entry is None:
        return None
    if len(entry) != 1:
        raise UserError(f"{where}: expected one of tag, board and height, got {' and '.join(entry) or 'none'}.")
    ((source, value),) = entry.items()
    if source == "board":
        length = read_length(value["square"], f"{where}.board.square")
        return {"source": source, "length": length / 1000, "corners": [*value["corners"]]}
    return {"source": source, "length": read_length(value, f"{where}.{source}") / 1000}
