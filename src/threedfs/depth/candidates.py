"""The discrete depths that the cost volume is sampled at."""

from __future__ import annotations

import numpy as np

from threedfs.errors import UserError

SPACINGS = ("power", "inverse", "log")

_SAMPLES = 4097
"""Depths listed over the range, to find the share of the way at which a given depth lies."""


def space_candidates(
    near: float,
    far: float,
    count: int,
    spacing: str,
    within: tuple[float, float] | None = None,
    outside_step: float = 1.0,
) -> np.ndarray:
    """Space depth candidates over an expected range, ascending.

    Differs from the paper: where it is known what part of the range holds the object (`within`), steps are longer
    outside of that part.

    Parameters
    ----------
    near, far : float
        First and last candidate, scene units, 0 < near < far.
    count : int
        Number of candidates, at least 3.
    spacing : {"power", "inverse", "log"}
        ``power`` is the paper's ((0.2 + 0.8 i / count)^5 for i = 1 .. count) scaled to the range (Section 4.2);
        ``inverse`` is uniform in inverse depth, that is nearly uniform along epipolar lines; ``log`` is geometric.
    within : tuple of float, optional
        Nearest and farthest depth of the object's box, scene units.
    outside_step : float
        Length of a step outside that part over that of a step inside it, as `spacing` measures steps.

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
    if spacing not in SPACINGS:
        raise UserError(f"depth.spacing: expected one of {', '.join(SPACINGS)}, got {spacing}.")
    even = np.linspace(0, 1, count)
    if within is None or outside_step == 1:
        return _place(even, near, far, count, spacing)
    samples = np.linspace(0, 1, _SAMPLES)
    first, last = np.interp(np.clip(within, near, far), _place(samples, near, far, count, spacing), samples)
    knots = np.array([0, first, last, 1])
    steps = np.cumsum([0, first / outside_step, last - first, (1 - last) / outside_step])
    return _place(np.interp(even * steps[-1], steps, knots), near, far, count, spacing)


def _place(share: np.ndarray, near: float, far: float, count: int, spacing: str) -> np.ndarray:
    """Return the depths (N,) that lie at shares (N,) in [0, 1] of the way through evenly spaced candidates."""
    if spacing == "power":
        powers, first = (0.2 + 0.8 * (1 + share * (count - 1)) / count) ** 5, (0.2 + 0.8 / count) ** 5
        return near + (far - near) * (powers - first) / (1 - first)
    if spacing == "inverse":
        return 1 / (1 / near + share * (1 / far - 1 / near))
    return near * (far / near) ** share
