"""Small artifacts as JSON, sorted so that the same content has the same bytes."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from threedfs.errors import UserError
from threedfs.io.atomic import atomic
from threedfs.io.schema import Schema, check_schema


def write_document(path: Path, schema: Schema, content: Mapping[str, Any], header: Mapping[str, Any]) -> None:
    """Write a mapping of plain values under a schema; NaN is refused."""
    text = json.dumps({"schema": schema.name, **header, **content}, sort_keys=True, indent=1, allow_nan=False)
    with atomic(path) as temporary:
        temporary.write_text(text + "\n", encoding="utf-8")


def read_document(path: Path, schema: Schema) -> dict[str, Any]:
    """Read a mapping written by `write_document`.

    Raises
    ------
    UserError
        If the file is missing, is not JSON, or has another schema.
    """
    path = Path(path)
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise UserError(
            f"{path}: expected a file of schema {schema.name}, found none; rule {schema.rules} writes it."
        ) from None
    except (UnicodeDecodeError, json.JSONDecodeError) as fault:
        raise UserError(f"{path}: expected JSON of schema {schema.name}, got something else ({fault}).") from fault
    check_schema(path, content.get("schema"), schema)
    return content
