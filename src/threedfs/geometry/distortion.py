"""Radial lens distortion and its inverse, in normalised image coordinates."""

from __future__ import annotations

import numpy as np

_NEWTON_STEPS = 50
_CONVERGED = 1e-13


def distort(points: np.ndarray, distortion: tuple[float, float]) -> np.ndarray:
    """Move ideal points to where the lens images them: x_d = x (1 + k1 r^2 + k2 r^4).

    Parameters
    ----------
    points : (..., 2) float64
        Normalised (x, y), that is pixels without centre and focal length.
    distortion : tuple of float
        (k1, k2).

    Returns
    -------
    (..., 2) float64
        NaN beyond the radius where the model turns back (there it would show the inside of the image again).
    """
    k1, k2 = distortion
    square = np.sum(points**2, axis=-1, keepdims=True)
    factor = 1 + square * (k1 + square * k2)
    return np.where(square < turning_radius(distortion) ** 2, points * factor, np.nan)


def undistort(points: np.ndarray, distortion: tuple[float, float]) -> np.ndarray:
    """Invert `distort`: points (..., 2) float64 as imaged to ideal ones; NaN where no ideal point maps.

    The radius is found by Newton's method on r (1 + k1 r^2 + k2 r^4) = r_d, kept inside the bracket that bisection
    maintains, so that it converges wherever a solution exists.
    """
    k1, k2 = distortion
    if k1 == 0 and k2 == 0:
        return np.array(points, dtype=np.float64)
    imaged = np.linalg.norm(points, axis=-1)
    low, high = np.zeros_like(imaged), np.full_like(imaged, turning_radius(distortion))
    # A model without a turning point grows without bound: doubling finds an upper end.
    high = np.where(np.isinf(high), np.maximum(imaged, 1e-12), high)
    if np.isinf(turning_radius(distortion)):
        while np.any(_image_radius(high, k1, k2) < imaged):
            high = np.where(_image_radius(high, k1, k2) < imaged, 2 * high, high)
    solvable = _image_radius(high, k1, k2) >= imaged
    radius = np.minimum(imaged, high)
    for _ in range(_NEWTON_STEPS):
        error = _image_radius(radius, k1, k2) - imaged
        high = np.where(error > 0, radius, high)
        low = np.where(error > 0, low, radius)
        slope = 1 + radius**2 * (3 * k1 + 5 * k2 * radius**2)
        step = np.divide(error, slope, out=np.full_like(error, np.inf), where=slope > 0)
        moved = np.where((radius - step >= low) & (radius - step <= high), radius - step, (low + high) / 2)
        change = np.max(np.abs(moved - radius), where=solvable, initial=0.0)
        radius = moved
        if change < _CONVERGED:
            break
    factor = np.divide(radius, imaged, out=np.ones_like(radius), where=imaged > 0)
    return np.where(solvable, factor, np.nan)[..., None] * points


def turning_radius(distortion: tuple[float, float]) -> float:
    """Return the ideal radius up to which the imaged radius grows; infinite if it always does.

    Examples
    --------
    >>> turning_radius((-1 / 3, 0.0))
    1.0
    >>> turning_radius((0.1, 0.0))
    inf
    """
    k1, k2 = distortion
    # d/dr = 1 + 3 k1 s + 5 k2 s^2 with s = r^2; the nearest positive root, if any.
    roots = np.roots([5 * k2, 3 * k1, 1.0]) if k2 else np.roots([3 * k1, 1.0]) if k1 else np.array([])
    positive = [root.real for root in roots if abs(root.imag) < 1e-12 and root.real > 0]
    return float(np.sqrt(min(positive))) if positive else np.inf


def _image_radius(radius, k1, k2):
    return radius * (1 + radius**2 * (k1 + k2 * radius**2))
