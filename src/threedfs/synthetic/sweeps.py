"""Shapes drawn by curves and outlines: limbs, horns, wires, plates. Fields like those in `fields`."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numba import njit

from threedfs.synthetic.fields import Field


def spline(knots: Sequence[Sequence[float]], pieces: int = 8, closed: bool = False) -> np.ndarray:
    """Sample a smooth curve through knots (N, D), `pieces` samples from one knot to the next (Catmull-Rom).

    An open curve ends with the last knot; a closed one goes back to the first and does not repeat it.
    """
    knots = np.asarray(knots, float)
    if closed:
        before, start, end, after = (np.roll(knots, shift, axis=0) for shift in (1, 0, -1, -2))
    else:
        # Beyond its ends the curve goes straight on.
        padded = np.concatenate([2 * knots[:1] - knots[1:2], knots, 2 * knots[-1:] - knots[-2:-1]])
        before, start, end, after = padded[:-3], padded[1:-2], padded[2:-1], padded[3:]
    t = (np.arange(pieces) / pieces)[:, None]
    leave, arrive = (end - before)[:, None] / 2, (after - start)[:, None] / 2
    start, end = start[:, None], end[:, None]
    curve = (
        (2 * t**3 - 3 * t**2 + 1) * start
        + (t**3 - 2 * t**2 + t) * leave
        + (3 * t**2 - 2 * t**3) * end
        + (t**3 - t**2) * arrive
    ).reshape(-1, knots.shape[1])
    return curve if closed else np.concatenate([curve, knots[-1:]])


def round_cones(cones: Iterable[tuple[Sequence[float], Sequence[float], float, float]]) -> Field:
    """Join many round cones at little cost: (a, b, radius_a, radius_b) each, as for `fields.round_cone`."""
    rows = np.array([(*a, *b, radius_a, radius_b) for a, b, radius_a, radius_b in cones], np.float64)
    return lambda points: _round_cones(np.ascontiguousarray(points, np.float64), rows)


def tube(knots: Sequence[Sequence[float]], radii: Sequence[float], pieces: int = 8) -> Field:
    """Make a limb along the spline through knots (N, 3); its radius goes smoothly through `radii` (N,)."""
    curve = spline(np.column_stack([knots, radii]), pieces)
    centres, radius = curve[:, :3], curve[:, 3]
    return round_cones(zip(centres[:-1], centres[1:], radius[:-1], radius[1:], strict=True))


def prism(outline: np.ndarray, low: float, high: float, axis: int = 2, rounding: float = 0.0) -> Field:
    """Make a plate: a polygon pushed from `low` to `high` along an axis, its rims rounded inwards by `rounding`.

    Parameters
    ----------
    outline : (N, 2) float
        Corners in either direction of turn, in the other two axes in their order: (y, z) for axis 0.
    low, high : float
    axis : int
    rounding : float
    """
    corners = np.ascontiguousarray(outline, np.float64)
    middle, half = (low + high) / 2, (high - low) / 2

    def field(points: np.ndarray) -> np.ndarray:
        flat = np.ascontiguousarray(np.delete(points, axis, axis=-1), np.float64)
        across = _polygon(flat, corners) + rounding
        along = np.abs(points[..., axis] - middle) - half + rounding
        outside = np.hypot(np.maximum(across, 0), np.maximum(along, 0))
        return outside + np.minimum(np.maximum(across, along), 0) - rounding

    return field


@njit(cache=True)
def _round_cones(points: np.ndarray, cones: np.ndarray) -> np.ndarray:
    """Distance to the nearest of the cones (M, 8); the formula of `fields.round_cone`."""
    out = np.full(len(points), np.inf)
    for m in range(len(cones)):
        ax, ay, az, bx, by, bz, radius, end = cones[m]
        bx, by, bz = bx - ax, by - ay, bz - az
        length = np.sqrt(bx * bx + by * by + bz * bz)
        slope = (radius - end) / max(length, 1e-12)
        if abs(slope) >= 1:  # one ball holds the other
            if end > radius:
                ax, ay, az, radius = ax + bx, ay + by, az + bz, end
            slope, length = 0.0, 0.0
        scale = 1 / max(length, 1e-12)
        lean = slope / np.sqrt(1 - slope * slope)
        for n in range(len(points)):
            x, y, z = points[n, 0] - ax, points[n, 1] - ay, points[n, 2] - az
            along = (x * bx + y * by + z * bz) * scale if length > 0 else 0.0
            across = np.sqrt(max(x * x + y * y + z * z - along * along, 0.0))
            foot = min(max(along - across * lean, 0.0), length)
            value = np.sqrt(across * across + (along - foot) ** 2) - (radius - slope * foot)
            out[n] = min(out[n], value)
    return out


@njit(cache=True)
def _polygon(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Signed distance (N,) of points (N, 2) to a polygon, negative inside (even-odd rule)."""
    out = np.empty(len(points))
    for n in range(len(points)):
        x, y = points[n]
        nearest, inside = np.inf, False
        for m in range(len(corners)):
            ax, ay = corners[m]
            bx, by = corners[(m + 1) % len(corners)]
            dx, dy = bx - ax, by - ay
            t = min(max(((x - ax) * dx + (y - ay) * dy) / max(dx * dx + dy * dy, 1e-24), 0.0), 1.0)
            nearest = min(nearest, (x - ax - t * dx) ** 2 + (y - ay - t * dy) ** 2)
            if (ay > y) != (by > y) and x < ax + (y - ay) / dy * dx:
                inside = not inside
        out[n] = -np.sqrt(nearest) if inside else np.sqrt(nearest)
    return out
