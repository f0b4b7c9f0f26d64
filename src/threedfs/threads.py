"""How many threads compiled kernels use."""

from __future__ import annotations

import numba


def use_threads(threads: int) -> None:
    """Let the parallel kernels that follow use as many threads as asked for: at least one, at most those there are."""
    most: int = numba.config.NUMBA_NUM_THREADS  # type: ignore[attr-defined]
    numba.set_num_threads(max(1, min(threads, most)))
