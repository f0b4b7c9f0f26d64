"""What matches the patches that become surface points."""

from __future__ import annotations


def choose_engine(points: bool, engine: str, cuda: bool) -> str:
    """Return what matches patches: "cpu", "cuda", or "off" for nothing.

    Parameters
    ----------
    points : bool
        Whether surface points are wanted.
    engine : {"auto", "cpu", "cuda"}
    cuda : bool
        Whether COLMAP can match patches on this machine; decides "auto".

    Examples
    --------
    >>> choose_engine(True, "auto", False), choose_engine(False, "cuda", True)
    ('cpu', 'off')
    """
    if not points:
        return "off"
    if engine == "auto":
        return "cuda" if cuda else "cpu"
    return engine
