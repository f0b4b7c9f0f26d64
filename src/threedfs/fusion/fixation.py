"""What all views look at, and which way is up."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from threedfs.types import View


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

    Parameters
    ----------
    views : sequence of View
    fixation : (3,) float64
    rolled_gain : float
        In [0, 1]; the length of the mean of unit vectors is at most 1.
    """
    upward = -np.mean([view.cam_from_world[1, :3] for view in views], axis=0)
    sideways = np.mean([view.cam_from_world[0, :3] for view in views], axis=0)
    rolled = np.linalg.norm(sideways) > np.linalg.norm(upward) + rolled_gain
    up = sideways if rolled else upward
    toward_cameras = np.mean([view.centre for view in views], axis=0) - fixation
    if up @ toward_cameras < 0:
        up = -up
    return up / np.linalg.norm(up)
