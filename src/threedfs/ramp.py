"""A share that grows between two values."""

from __future__ import annotations

import numpy as np


def rise(values: float | np.ndarray, start: float, full: float) -> np.ndarray:
    """Return 1 from `full` on, 0 up to `start`, and a line between; `full` decides where they do not leave room."""
    return np.where(np.asarray(values) >= full, 1.0, np.clip((values - start) / max(full - start, 1e-9), 0.0, 1.0))
