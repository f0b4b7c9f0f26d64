"""The takes of Tabletop-12, a module each with a function `make_take`; found by name.

Nothing here imports them: an edit in one take makes that one new and leaves the others valid.
"""

from __future__ import annotations

import importlib
import pkgutil
from typing import TYPE_CHECKING

from threedfs.errors import UserError

if TYPE_CHECKING:
    from threedfs.synthetic.tabletop import Take

DEPTH_SCALE = 10000.0
"""Levels of a true depth image in a scene unit: a level is 0.1 mm, and the largest depth 6.5 m."""


def list_takes() -> tuple[str, ...]:
    """Return the names of all takes, sorted."""
    return tuple(sorted(module.name for module in pkgutil.iter_modules(__path__)))


def take_module(name: str) -> str:
    """Return the full name of a take's module.

    Raises
    ------
    UserError
        If there is no such take.
    """
    if name not in list_takes():
        raise UserError(f"rendered: expected one of {', '.join(list_takes())}, got {name!r}.")
    return f"{__name__}.{name}"


def make_take(name: str) -> Take:
    """Make a take by its name."""
    return importlib.import_module(take_module(name)).make_take()
