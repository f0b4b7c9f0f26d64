"""Which photographs a mesh is painted from, and which are left out to compare its pictures with."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from threedfs.types import View


def hold_out(names: Sequence[str], step: int) -> list[str]:
    """Return one of every `step` names, from the middle of the first steps on.

    None if `step` is 0, or if there are fewer names than three steps: of a few photographs each may be the only one to
    show a side.
    """
    return list(names[step // 2 :: step]) if 0 < 3 * step <= len(names) else []


def spread_views(views: Sequence[View], most: int) -> list[View]:
    """Return at most so many of the views, at uniform steps."""
    if len(views) <= most:
        return list(views)
    return [views[index] for index in np.linspace(0, len(views) - 1, most).round().astype(int)]
