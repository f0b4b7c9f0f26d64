"""The discrete depths that the cost volume is sampled at."""

from __future__ import annotations

import numpy as np

from threedfs.errors import UserError

SPACINGS = ("power", "inverse", "log")


def space_candidates(near: float, far: float, count: int, spacing: str) -> np.ndarray:
    """Space depth candidates over an expected range, ascending.

    Parameters
    ----------
    near, far : float
        First and last candidate, scene units, 0 < near < far.
    count : int
        Number of candidates, at least 3.
    spacing : {"power", "inverse", "log"}
        ``power`` is the paper's ((0.2 + 0.8 i / count)^5 for i = 1 .. count) scaled to the range (Section 4.2);
        ``inverse`` is uniform in inverse depth, that is nearly uniform along epipolar lines; ``log`` is geometric.

    Returns
    -------
    (count,) float64, scene units

    Raises
    ------
    UserError
        If the range is empty or not positive, or the spacing is unknown.

    Examples
    --------
    >>> space_candidates(1.0, 2.0, 3, "inverse").round(3)
    array([1.   , 1.333, 2.   ])
    """
    if not 0 < near < far:
        raise UserError(f"depth candidates: expected 0 < near < far, got near = {near:.4g} and far = {far:.4g}.")
    if spacing == "power":
        powers = (0.2 + 0.8 * np.arange(1, count + 1) / count) ** 5
        return near + (far - near) * (powers - powers[0]) / (powers[-1] - powers[0])
    if spacing == "inverse":
        return 1 / np.linspace(1 / near, 1 / far, count)
    if spacing == "log":
        return np.geomspace(near, far, count)
    raise UserError(f"depth.spacing: expected one of {', '.join(SPACINGS)}, got {spacing}.")
