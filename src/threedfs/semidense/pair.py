"""The epipolar geometry of a keyframe and one neighbour."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from threedfs.types import View


class PairGeometry(NamedTuple):
    """How a pixel (u, v) at an inverse depth is seen by a neighbour.

    Attributes
    ----------
    infinite : (3, 3) float64
        Homogeneous pixel in the neighbour = infinite @ (u, v, 1) + inverse depth * baseline.
    baseline : (3,) float64
    epipole : (3,) float64
        The neighbour's centre as homogeneous pixel of the keyframe.
    """

    infinite: np.ndarray
    baseline: np.ndarray
    epipole: np.ndarray


def relate(keyframe: View, neighbour: View) -> PairGeometry:
    """Compute the geometry between a keyframe and a neighbour, whose cameras may differ."""
    other_from_key = neighbour.cam_from_world @ np.linalg.inv(keyframe.cam_from_world)
    rotation, translation = other_from_key[:3, :3], other_from_key[:3, 3]
    key_px, other_px = keyframe.camera.px_from_cam, neighbour.camera.px_from_cam
    return PairGeometry(
        infinite=np.ascontiguousarray(other_px @ rotation @ np.linalg.inv(key_px)),
        baseline=other_px @ translation,
        epipole=key_px @ (-rotation.T @ translation),
    )
