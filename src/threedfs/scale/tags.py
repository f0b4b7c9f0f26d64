"""Printed square markers: ArUco and AprilTag, of all common dictionaries."""

from __future__ import annotations

from functools import cache

import cv2
import numpy as np

_FAMILIES = {
    # the largest of each family holds the smaller ones
    "4x4": cv2.aruco.DICT_4X4_1000,
    "5x5": cv2.aruco.DICT_5X5_1000,
    "6x6": cv2.aruco.DICT_6X6_1000,
    "7x7": cv2.aruco.DICT_7X7_1000,
    "original": cv2.aruco.DICT_ARUCO_ORIGINAL,
    "mip_36h12": cv2.aruco.DICT_ARUCO_MIP_36h12,
    "april_16h5": cv2.aruco.DICT_APRILTAG_16h5,
    "april_25h9": cv2.aruco.DICT_APRILTAG_25h9,
    "april_36h10": cv2.aruco.DICT_APRILTAG_36h10,
    "april_36h11": cv2.aruco.DICT_APRILTAG_36h11,
}
CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
"""Where the corners of a tag lie on it, in its sides, in the order in which they are found."""

_GAMMA = 2.2
_BORDER = 1 / 12
"""Share of a side that is surely black: the border of the finest family is a ninth wide, and blur takes some of it."""
_PLACES = np.linspace(0.12, 0.88, 32)
"""Where along a side its edge is looked for; blur rounds the corners."""
_STEP = 0.25  # pixels between samples across an edge
_LEAST_REACH = 1.2  # pixels


def find_tags(image: np.ndarray, window: int) -> dict[str, np.ndarray]:
    """Find the tags that an image shows, and their corners to a fraction of a pixel.

    A corner is the outer one of the black border: a side is as long as the black square.

    Parameters
    ----------
    image : (H, W, 3) uint8 RGB
    window : int
        How far to either side an edge of the square is looked for, pixels; of small tags less far.

    Returns
    -------
    dict of str to (4, 2) float64
        Pixels (u, v), clockwise from the tag's own upper left, by family and number, as in `april_36h11 7`. What
        is seen twice in one image is left out: it does not tell which of the two it is.
    """
    grey = cv2.cvtColor(image, cv2.COLOR_RGB2GRAY)
    corners, numbers, _, families = _make_detector().detectMarkersMultiDict(grey)
    if numbers is None:
        return {}
    # An edge blurs in light, not in grey levels: half way between levels lies within the black.
    light = (grey.astype(np.float32) / 255) ** _GAMMA
    names = [*_FAMILIES]
    found: dict[str, list[np.ndarray | None]] = {}
    for points, number, family in zip(corners, np.ravel(numbers), np.ravel(families), strict=True):
        refined = refine_square(light, points.reshape(4, 2).astype(np.float64), window)
        found.setdefault(f"{names[int(family)]} {number}", []).append(refined)
    return {name: seen[0] for name, seen in sorted(found.items()) if len(seen) == 1 and seen[0] is not None}


def refine_square(light: np.ndarray, corners: np.ndarray, window: float) -> np.ndarray | None:
    """Find the corners of a black square on white where straight lines along its edges meet.

    Corners themselves are rounded off by blur, by which the square would seem smaller; edges stay where they are.

    Parameters
    ----------
    light : (H, W) float32
        Linear in light.
    corners : (4, 2) float64
        Pixels (u, v), clockwise in the image, right to about a pixel.
    window : float
        How far to either side an edge is looked for, pixels.

    Returns
    -------
    (4, 2) float64 or None
        None where the square is too small to tell.
    """
    lines = []
    area = float(cv2.contourArea(corners.astype(np.float32)))
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        along = end - start
        length = float(np.hypot(*along))
        reach = min(window, _BORDER * area / length)  # seen aslant, the border is narrow
        if reach < _LEAST_REACH:
            return None
        inward = np.array([-along[1], along[0]]) / length
        offsets = np.arange(-reach, reach + _STEP / 2, _STEP)
        middles = start + _PLACES[:, None] * along
        points = (middles[:, None] + offsets[:, None] * inward).astype(np.float32)
        profile = cv2.remap(light, points[..., 0], points[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        bright, dark = np.median(profile[:, 0]), np.median(profile[:, -1])
        if bright <= dark:
            return None
        # The area under a profile tells where its step is, however blurred.
        shares = np.clip((profile - dark) / (bright - dark), 0, 1)
        edges = -reach + np.trapezoid(shares, dx=offsets[1] - offsets[0], axis=1)
        lines.append(_fit_line(middles + edges[:, None] * inward))
    return np.array([_meet(lines[side - 1], lines[side]) for side in range(4)])


def _fit_line(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the direction (2,) of a line and a point (2,) of it; what a shadow or a blot moved counts little."""
    line = np.ravel(cv2.fitLine(points.astype(np.float32), cv2.DIST_HUBER, 0, 1e-4, 1e-5)).astype(np.float64)
    return line[:2], line[2:]


def _meet(first: tuple[np.ndarray, np.ndarray], second: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    (along, point), (other, base) = first, second
    steps = np.linalg.solve(np.stack([along, -other], axis=1), base - point)
    return point + steps[0] * along


@cache
def _make_detector() -> cv2.aruco.ArucoDetector:
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    dictionaries = [cv2.aruco.getPredefinedDictionary(family) for family in _FAMILIES.values()]
    return cv2.aruco.ArucoDetector(dictionaries, parameters)
