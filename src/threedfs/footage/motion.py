"""How the camera moved between frames, as far as matches tell before any reconstruction."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from threedfs.footage.look import Look

_RATIO = 0.8
_FEWEST = 20  # matches that a geometry can be trusted with
_FOCAL = 0.85  # of a phone's main camera, in longer sides of the image: that of about 26 mm
_TOLERANCE = 1.5  # pixels


@dataclass(frozen=True)
class Step:
    """From one frame to a later one.

    Attributes
    ----------
    matches : int
        Keypoints that agree with one camera motion.
    shift : float
        Median way of these in the image, share of its longer side.
    parallax : float
        Median way that is left of them when the best turn or plane is taken off, share of the longer side.
    rotation : (3, 3) float64 or None
        Of the camera, second from first; None where matches are too few.
    """

    matches: int
    shift: float
    parallax: float
    rotation: np.ndarray | None


def measure_step(first: Look, second: Look, shape: tuple[int, int]) -> Step:
    """Match two frames of (rows, columns) and find how the camera moved between them."""
    if min(len(first.pixels), len(second.pixels)) < _FEWEST:
        return Step(0, 0.0, 0.0, None)
    pairs = cv2.BFMatcher().knnMatch(first.descriptors, second.descriptors, k=2)
    good = [pair[0] for pair in pairs if len(pair) == 2 and pair[0].distance < _RATIO * pair[1].distance]
    if len(good) < _FEWEST:
        return Step(len(good), 0.0, 0.0, None)
    here = np.array([first.pixels[match.queryIdx] for match in good], np.float64)
    there = np.array([second.pixels[match.trainIdx] for match in good], np.float64)
    side = max(shape)
    camera = np.array([[_FOCAL * side, 0, shape[1] / 2], [0, _FOCAL * side, shape[0] / 2], [0, 0, 1.0]])
    cv2.setRNGSeed(0)
    essential, inside = cv2.findEssentialMat(here, there, camera, cv2.RANSAC, 0.999, 2 * _TOLERANCE)
    if essential is None or essential.shape != (3, 3) or inside.sum() < _FEWEST:
        return Step(0, 0.0, 0.0, None)
    kept = inside.ravel() > 0
    here, there = here[kept], there[kept]
    shift = float(np.median(np.linalg.norm(there - here, axis=1))) / side
    _, rotation, _, _ = cv2.recoverPose(essential, here, there, camera)
    plane, _ = cv2.findHomography(here, there, cv2.RANSAC, _TOLERANCE)
    parallax = 0.0
    if plane is not None:
        moved = cv2.perspectiveTransform(here[:, None], plane)[:, 0]
        parallax = float(np.percentile(np.linalg.norm(moved - there, axis=1), 75)) / side
    return Step(int(kept.sum()), shift, parallax, rotation if shift > _TOLERANCE / side else np.eye(3))


def sweep_angle(rotations: Sequence[np.ndarray | None]) -> float:
    """Return how far around the camera looked, degrees: the way of its optical axis as the steps turn it on.

    A camera that walks around a thing and keeps it in view turns as far as it walks; steps that are not known count
    as none.
    """
    axis, turned = np.eye(3), 0.0
    directions = [axis[2]]
    for rotation in rotations:
        if rotation is not None:
            axis = rotation @ axis
        directions.append(axis[2])
    for before, after in itertools.pairwise(directions):
        turned += float(np.degrees(np.arccos(np.clip(before @ after, -1, 1))))
    return turned
