"""The size of a scene from points of it whose true distances are known."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from threedfs.geometry.lens import Lens
from threedfs.scale.triangulate import triangulate

_SHARE_OF_LONGEST = 0.5  # shorter distances say little, their errors are as large as those of long ones
_SIXTHS = (100 / 6, 500 / 6)  # percentiles between which two thirds of the values lie


@dataclass(frozen=True)
class Measurement:
    """How large a unit of the scene is.

    Attributes
    ----------
    scale : float
        Known length of a unit of the scene, in the unit of the known distances.
    spread : float
        Half of the range in which two thirds of the single distances put it, as a share of it.
    frames : int
        That see the points.
    """

    scale: float
    spread: float
    frames: int


def measure_pattern(
    seen: Mapping[str, np.ndarray],
    places: np.ndarray,
    lenses: Mapping[str, Lens],
    cam_from_world: Mapping[str, np.ndarray],
) -> Measurement | None:
    """Compare the distances between the points of a flat pattern with those that they have in the scene.

    Parameters
    ----------
    seen : mapping of str to (P, 2) float64
        Pixels (u, v) of the points as filmed, by frame.
    places : (P, 2) float64
        Where they lie on the pattern, in the unit that the scale is to have.
    lenses : mapping of str to Lens
    cam_from_world : mapping of str to (4, 4) float64

    Returns
    -------
    Measurement or None
        None where fewer than two frames see them, or where these do not tell how far away they are.
    """
    if len(seen) < 2:
        return None
    rays = np.stack([lenses[name].normalise(pixels) for name, pixels in seen.items()])
    whole = np.isfinite(rays).all(axis=(1, 2))
    if whole.sum() < 2:
        return None
    rays, poses = rays[whole], np.stack([cam_from_world[name] for name in seen])[whole]
    focal = float(np.median([lenses[name].camera.fx for name in seen]))
    points = np.array([triangulate(rays[:, index], poses, focal) for index in range(len(places))])
    if not np.isfinite(points).all():
        return None
    first, second = np.triu_indices(len(places), 1)
    known = np.linalg.norm(places[first] - places[second], axis=1)
    long = known >= _SHARE_OF_LONGEST * known.max()
    measured = np.linalg.norm(points[first] - points[second], axis=1)[long]
    if not (measured > 0).all():
        return None
    ratios = known[long] / measured
    scale = float(np.median(ratios))
    low, high = np.percentile(ratios, _SIXTHS)
    return Measurement(scale, float(high - low) / (2 * scale), len(rays))


def choose_tag(measurements: Mapping[str, Measurement], min_frames: int, max_spread: float) -> list[str]:
    """Name the tags to believe in: squares that enough frames see.

    What looks like a tag by chance is seen in few frames, or is no square.

    Parameters
    ----------
    measurements : mapping of str to Measurement
    min_frames : int
    max_spread : float
        Largest spread of a tag's distances, as a share.

    Returns
    -------
    list of str
        The tag that most frames see first; those in fewer than half as many frames are left out.
    """
    sound = [name for name, each in measurements.items() if each.frames >= min_frames and each.spread <= max_spread]
    sound.sort(key=lambda name: (-measurements[name].frames, name))
    return [name for name in sound if 2 * measurements[name].frames >= measurements[sound[0]].frames]
