"""What all views look at, and which way is up."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from threedfs.errors import UserError
from threedfs.types import View

_LEAST_COMMON = 0.5
"""Length of the mean upward axis below which it is not believed alone: that of an orbit 60 degrees up."""

_LEAST_UP = 0.05
"""Length of the guess below which it is chance."""


def find_fixation(views: Sequence[View], centre: np.ndarray, centre_weight: float = 0.01) -> np.ndarray:
    """Find the world point nearest to the optical axes of all views, in least squares.

    Parameters
    ----------
    views : sequence of View
    centre : (3,) float64
        Where the scene is; it decides only along directions that the axes leave open, as nearly parallel ones do.
    centre_weight : float
        Weight of `centre` against one view.

    Returns
    -------
    (3,) float64
    """
    matrix = centre_weight * len(views) * np.eye(3)
    right = matrix @ centre
    for view in views:
        axis = view.cam_from_world[2, :3]
        across = np.eye(3) - np.outer(axis, axis)
        matrix += across
        right += across @ view.centre
    return np.linalg.solve(matrix, right)


def viewing_distance(views: Sequence[View], fixation: np.ndarray) -> float:
    """Return the median distance of the cameras from the fixation point, scene units."""
    return float(np.median([np.linalg.norm(view.centre - fixation) for view in views]))


def find_up(views: Sequence[View], fixation: np.ndarray, rolled_gain: float = 0.3) -> np.ndarray:
    """Guess the direction away from the ground, a unit vector (3,), from the cameras' own upward axes.

    While a camera goes around an object its upward axis keeps a common part, its sideways axis has none. A camera
    held rolled by a quarter or half turn has another axis up: that is believed where its common part is longer
    by `rolled_gain`. Cameras look down at what stands on a surface, which decides the sign.

    Cameras that go around steeply above the object have no upward axis in common. The shorter that part is below
    `_LEAST_COMMON`, the more the mean direction from the fixation point to the cameras joins in.

    Parameters
    ----------
    views : sequence of View
    fixation : (3,) float64
    rolled_gain : float
        In [0, 1]; the length of the mean of unit vectors is at most 1.

    Raises
    ------
    UserError
        If neither the axes nor the places of the cameras have a common part.
    """
    upward = -np.mean([view.cam_from_world[1, :3] for view in views], axis=0)
    sideways = np.mean([view.cam_from_world[0, :3] for view in views], axis=0)
    rolled = np.linalg.norm(sideways) > np.linalg.norm(upward) + rolled_gain
    up = sideways if rolled else upward
    toward_cameras = np.mean([view.centre for view in views], axis=0) - fixation
    if up @ toward_cameras < 0:
        up = -up
    common = np.linalg.norm(up)
    if common < _LEAST_COMMON:
        up = up + (1 - common / _LEAST_COMMON) * _mean_direction(views, fixation)
    length = np.linalg.norm(up)
    if length < _LEAST_UP:
        raise UserError(
            "The cameras do not tell which way is up: expected views from above of an object on a flat surface, got "
            "views from all around it; check the given cameras."
        )
    return up / length


def _mean_direction(views: Sequence[View], fixation: np.ndarray) -> np.ndarray:
    """Return the mean (3,) of the unit directions from the fixation point to the cameras."""
    offsets = np.stack([view.centre for view in views]) - fixation
    return np.mean(offsets / np.maximum(np.linalg.norm(offsets, axis=1, keepdims=True), 1e-12), axis=0)
