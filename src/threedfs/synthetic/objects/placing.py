"""Turning and moving parts together with their textures."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from threedfs.synthetic.fields import Field, place
from threedfs.synthetic.solid import Material, Part, Texture


def about_z(degrees: float) -> np.ndarray:
    """Return the rotation (3, 3) about z."""
    cosine, sine = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])


def placed(field: Field, material: Material, translation: Sequence[float], rotation: np.ndarray) -> Part:
    """Make a part that is turned about the origin, then moved, its texture with it."""
    texture = place_texture(material.texture, translation, rotation)
    return Part(
        place(field, translation, rotation),
        Material(texture, material.specular, material.shininess, material.mirror),
    )


def place_texture(texture: Texture, translation: Sequence[float], rotation: np.ndarray) -> Texture:
    """Turn a texture about the origin, then move it."""
    return lambda points, footprint: texture((points - np.asarray(translation)) @ rotation, footprint)


def side_of_box(points: np.ndarray, half: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
    """Say on which face of a box around the origin points (N, 3) lie.

    Returns
    -------
    side : (N,) int64
        0 to 5: -x, +x, -y, +y, -z, +z.
    flat : (N, 3) float64
        Coordinates on that face seen from outside, x to the right, y up (on -z and +z: the box's own x, y), z 0.
    """
    x, y, z = points.T
    relative = points / np.asarray(half)
    axis = np.abs(relative).argmax(axis=1)
    side = 2 * axis + (relative[np.arange(len(points)), axis] > 0)
    right = np.choose(side, [-y, y, x, -x, x, x])
    up = np.where(axis == 2, y, z)
    return side, np.column_stack([right, up, np.zeros(len(points))])
