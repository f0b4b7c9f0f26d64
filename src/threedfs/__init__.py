"""From a handheld video to the mesh of its object (3DFS, Gupta et al. 2016).

`threedfs.reconstruct` makes results of a video, `threedfs.open` reads results that were made.
"""

import importlib
from typing import Any

_OFFERED = {
    "open": ("threedfs.run_end.results", "open_results"),
    "reconstruct": ("threedfs.cli.run", "reconstruct"),
}


def __dir__() -> list[str]:
    return sorted([*_OFFERED, "__version__"])


def __getattr__(name: str) -> Any:
    """Import what is offered when it is asked for: the jobs of a run need none of it."""
    if name == "__version__":
        return importlib.import_module("importlib.metadata").version("threedfs")
    if name not in _OFFERED:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module, function = _OFFERED[name]
    return getattr(importlib.import_module(module), function)
