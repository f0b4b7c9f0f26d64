"""The region of interest: the box of the world that the scene grid covers."""

from __future__ import annotations

import numpy as np

from threedfs.errors import UserError
from threedfs.types import Box


def scene_region(points: np.ndarray, deviations: float, fixation: np.ndarray, least_reach: float, reach: float) -> Box:
    """Return the region of interest, along the axes of the world (Sec. 3.4.1).

    It reaches `deviations` standard deviations of the points to both sides of their median, axis by axis.

    Differs from the paper: the points are the sparse ones, not LSD-SLAM's semi-dense cloud; along each axis it
    reaches at least `least_reach` and at most `reach` from what the cameras look at. Points far behind the object
    would make the region so wide that the object is a few voxels; points mostly on the floor would make it so low
    that a tall object is cut off. `least_reach` 0 and a large `reach` give the paper's
    limits where what the cameras look at lies between them.

    Parameters
    ----------
    points : (N, 3) float64, world
        The sparse points.
    deviations : float
    fixation : (3,) float64
    least_reach, reach : float
        Scene units.

    Raises
    ------
    UserError
        If the points span no volume.
    """
    if len(points) < 4 or not np.all(points.std(axis=0) > 0):
        raise UserError(
            f"The scene has {len(points)} sparse points, which span no volume; expected at least some hundred; "
            "film a textured scene from several sides."
        )
    centre = np.median(points, axis=0)
    spread = deviations * points.std(axis=0)
    if not np.all(np.abs(centre - fixation) < spread + reach):
        raise UserError(
            "The cameras do not look at where the sparse points are; expected views of one object from around it; "
            "raise fuse_scene.region_reach or film the object in the middle of the picture."
        )
    low = np.clip(centre - spread, fixation - reach, fixation - least_reach)
    high = np.clip(centre + spread, fixation + least_reach, fixation + reach)
    return Box(np.eye(3), low, high)
