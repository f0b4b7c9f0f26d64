"""Makes the painted ball importable, and photographs it."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from painted_ball import ball, photograph, ring


@pytest.fixture(scope="session")
def photos():
    """Photographs of the ball by name, eight from a ring of cameras a little above it: they do not see its foot."""
    fine = ball(5)
    return {view.name: photograph(fine, view) for view in ring(8)}
