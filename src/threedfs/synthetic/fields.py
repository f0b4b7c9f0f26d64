"""Solid shapes as implicit functions: signed distances, negative inside, and the ways to combine them.

A field maps points (N, 3) to values (N,), in the unit of the points. Exact distances where the formula is
exact; otherwise the zero set is exact and the value is close to the distance near it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

Field = Callable[[np.ndarray], np.ndarray]


def sphere(centre: Sequence[float], radius: float) -> Field:
    """Make a ball."""
    return lambda points: np.linalg.norm(points - np.asarray(centre), axis=-1) - radius


def ellipsoid(centre: Sequence[float], radii: Sequence[float]) -> Field:
    """Make an ellipsoid with axes along x, y, z; the distance is first-order."""

    def field(points: np.ndarray) -> np.ndarray:
        local = points - np.asarray(centre)
        unit = np.linalg.norm(local / np.asarray(radii), axis=-1)
        slope = np.linalg.norm(local / np.asarray(radii) ** 2, axis=-1)
        return unit * (unit - 1) / np.maximum(slope, 1e-12)

    return field


def box(centre: Sequence[float], half: Sequence[float], rounding: float = 0.0) -> Field:
    """Make a box of half sizes `half`, its edges rounded inwards by `rounding`."""

    def field(points: np.ndarray) -> np.ndarray:
        q = np.abs(points - np.asarray(centre)) - (np.asarray(half) - rounding)
        outside = np.linalg.norm(np.maximum(q, 0), axis=-1)
        return outside + np.minimum(q.max(axis=-1), 0) - rounding

    return field


def round_cone(a: Sequence[float], b: Sequence[float], radius_a: float, radius_b: float) -> Field:
    """Make the hull of two balls around `a` and `b`; equal radii give a capsule."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    axis = b - a
    length = np.linalg.norm(axis)
    slope = (radius_a - radius_b) / length  # sine of the cone's half angle
    if abs(slope) >= 1:
        return sphere(a, radius_a) if radius_a > radius_b else sphere(b, radius_b)

    def field(points: np.ndarray) -> np.ndarray:
        local = points - a
        along = local @ axis / length
        across = np.sqrt(np.maximum((local**2).sum(-1) - along**2, 0))
        # The ball of a tapered hull that is nearest lies where the perpendicular to the cone meets the axis.
        foot = np.clip(along - across * slope / np.sqrt(1 - slope**2), 0, length)
        return np.hypot(across, along - foot) - (radius_a - slope * foot)

    return field


def cylinder(a: Sequence[float], b: Sequence[float], radius: float, rounding: float = 0.0) -> Field:
    """Make a cylinder between the points `a` and `b`, its rims rounded inwards by `rounding`."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    length = np.linalg.norm(b - a)
    direction = (b - a) / length

    def field(points: np.ndarray) -> np.ndarray:
        local = points - (a + b) / 2
        along = local @ direction
        across = np.sqrt(np.maximum((local**2).sum(-1) - along**2, 0))
        q = np.stack([across - radius + rounding, np.abs(along) - length / 2 + rounding], axis=-1)
        return np.linalg.norm(np.maximum(q, 0), axis=-1) + np.minimum(q.max(-1), 0) - rounding

    return field


def torus(centre: Sequence[float], axis: Sequence[float], radius: float, tube: float) -> Field:
    """Make a ring of radius `radius` around `axis` through `centre`, `tube` thick."""
    direction = np.asarray(axis, float) / np.linalg.norm(axis)

    def field(points: np.ndarray) -> np.ndarray:
        local = points - np.asarray(centre)
        along = local @ direction
        across = np.sqrt(np.maximum((local**2).sum(-1) - along**2, 0))
        return np.hypot(across - radius, along) - tube

    return field


def half_space(point: Sequence[float], normal: Sequence[float]) -> Field:
    """Make the half space behind the plane through `point` with the outward `normal`."""
    direction = np.asarray(normal, float) / np.linalg.norm(normal)
    return lambda points: (points - np.asarray(point)) @ direction


def union(*fields: Field) -> Field:
    """Join shapes."""
    return lambda points: np.minimum.reduce([field(points) for field in fields])


def intersection(*fields: Field) -> Field:
    """Keep what all shapes share."""
    return lambda points: np.maximum.reduce([field(points) for field in fields])


def subtract(field: Field, *cuts: Field) -> Field:
    """Cut shapes out of one."""
    return lambda points: np.maximum.reduce([field(points), *(-cut(points) for cut in cuts)])


def smooth_union(blend: float, *fields: Field) -> Field:
    """Join shapes with a fillet about `blend` wide."""

    def field(points: np.ndarray) -> np.ndarray:
        value = fields[0](points)
        for other in fields[1:]:
            more = other(points)
            h = np.maximum(blend - np.abs(value - more), 0) / blend
            value = np.minimum(value, more) - h * h * blend / 4
        return value

    return field


def offset(field: Field, distance: float) -> Field:
    """Grow a shape by `distance` (shrink where negative)."""
    return lambda points: field(points) - distance


def displace(field: Field, height: Callable[[np.ndarray], np.ndarray]) -> Field:
    """Raise the surface by `height(points)`; small against the shape."""
    return lambda points: field(points) - height(points)


def place(field: Field, translation: Sequence[float], rotation: np.ndarray | None = None) -> Field:
    """Move a shape: rotate it about the origin by a (3, 3) matrix, then translate it."""
    rotation = np.eye(3) if rotation is None else np.asarray(rotation)
    return lambda points: field((points - np.asarray(translation)) @ rotation)


def mirror_x(field: Field) -> Field:
    """Repeat the half x >= 0 of a shape on the other side."""
    return lambda points: field(np.concatenate([np.abs(points[..., :1]), points[..., 1:]], axis=-1))
