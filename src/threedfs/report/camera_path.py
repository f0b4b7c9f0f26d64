"""The camera's path, drawn from above."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from threedfs.geometry.plane import axes_on, widest_gap
from threedfs.types import Support, View

_SIZE, _EDGE = 420.0, 24.0
"""Pixels of the drawing, and of the room around what it shows."""


def draw_path(views: Sequence[View], keyframes: Collection[str], place: Support) -> str:
    """Return an SVG of all cameras from above the support plane: keyframes are larger, the object's box is in grey."""
    axes = axes_on(place.plane.normal)[:2]
    path = np.stack([view.centre for view in views]) @ axes.T
    box = place.box.corners() @ axes.T
    both = np.concatenate([path, box])
    low, span = both.min(axis=0), float(np.ptp(both, axis=0).max()) or 1.0

    def place_on_page(points: np.ndarray) -> np.ndarray:
        across, along = ((points - low) / span * (_SIZE - 2 * _EDGE) + _EDGE).T
        return np.stack([across, _SIZE - along], axis=1)

    corners = place_on_page(box[np.array(_hull_order(box))])
    points = place_on_page(path)
    line = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    dots = "".join(
        f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{4 if view.name in keyframes else 1.5}"/>'
        for view, (x, y) in zip(views, points, strict=True)
    )
    outline = " ".join(f"{x:.1f},{y:.1f}" for x, y in corners)
    return (
        f'<svg viewBox="0 0 {_SIZE:.0f} {_SIZE:.0f}" role="img" aria-label="the path of the camera from above">'
        f'<polygon points="{outline}" fill="#bbb"/><polyline points="{line}" fill="none" stroke="#7a9cc6"/>'
        f'<g fill="#1f4e8c">{dots}</g></svg>'
    )


def _hull_order(points: np.ndarray) -> list[int]:
    """Return the points' indices, around their middle."""
    away = points - points.mean(axis=0)
    return list(np.argsort(np.arctan2(away[:, 1], away[:, 0]), kind="stable"))


def unfilmed_angle(views: Sequence[View], place: Support) -> float:
    """Return the widest angle around the object, degrees, from which no camera looked at it."""
    return widest_gap(np.stack([view.centre - place.box.centre for view in views]), place.plane.normal)
