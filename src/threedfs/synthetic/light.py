"""Light: a round lamp with soft shadows, and light from all around."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from threedfs.geometry.raycast import RayCaster
from threedfs.geometry.vectors import dot, normalise


@dataclass(frozen=True)
class Light:
    """A ball of light, and the ambience of the room.

    Attributes
    ----------
    position : (3,) float
        Centre of the lamp, world.
    radius : float
        Its size: the larger, the softer the shadows.
    intensity : (3,) float
        Linear RGB; irradiance is intensity * cosine / distance**2.
    ambient : (3,) float
        Linear RGB of the light from all sides.
    """

    position: tuple[float, float, float]
    radius: float
    intensity: tuple[float, float, float]
    ambient: tuple[float, float, float]

    def irradiance(self, points: np.ndarray, normals: np.ndarray) -> np.ndarray:
        """Return what the unshadowed lamp gives to points (N, 3) with unit normals, (N, 3) linear RGB."""
        to_light = np.asarray(self.position) - points
        square = dot(to_light, to_light)
        cosine = np.maximum(dot(to_light, normals), 0) / np.sqrt(square)
        return (cosine / square)[:, None] * np.asarray(self.intensity)

    def highlight(
        self, points: np.ndarray, normals: np.ndarray, to_eye: np.ndarray, shininess: np.ndarray | float
    ) -> np.ndarray:
        """Return the Blinn-Phong highlight of the unshadowed lamp, (N, 3), for unit directions to the eye.

        It is normalised, so that a sharper one is brighter.
        """
        to_light = np.asarray(self.position) - points
        square = dot(to_light, to_light)
        to_light = to_light / np.sqrt(square)[:, None]
        half = normalise(to_light + to_eye)
        lobe = np.maximum(dot(half, normals), 0) ** shininess * (np.asarray(shininess) + 8) / 25
        lobe = lobe * (dot(to_light, normals) > 0) / square
        return lobe[:, None] * np.asarray(self.intensity)


def lamp_visibility(
    caster: RayCaster, light: Light, points: np.ndarray, normals: np.ndarray, rays: int, offset: float
) -> np.ndarray:
    """Return the share (N,) of the lamp that the mesh leaves visible from each point, by shadow rays.

    Rays end at points spread evenly over the lamp's disc and start `offset` above the surface.
    """
    start = points + offset * normals
    axis = np.asarray(light.position) - points.mean(axis=0)
    side, up = _frame(axis / np.linalg.norm(axis))
    seen = np.zeros(len(points))
    for x, y in _disc(rays):
        end = np.asarray(light.position) + light.radius * (x * side + y * up)
        seen += ~caster.is_blocked(start, end - start)
    return seen / rays


def openness(
    caster: RayCaster, points: np.ndarray, normals: np.ndarray, rays: int, offset: float, bounce: float
) -> np.ndarray:
    """Return the share (N,) of ambient light that reaches each point, by cosine-weighted rays.

    Rays that meet the mesh bring nothing; those that go down to the table bring `bounce`.
    """
    start = points + offset * normals
    helper = np.where(np.abs(normals[:, 2:]) < 0.9, [[0.0, 0, 1]], [[1.0, 0, 0]])
    side = normalise(np.cross(helper, normals))
    up = np.cross(normals, side)
    total = np.zeros(len(points))
    for x, y in _disc(rays):
        direction = x * side + y * up + np.sqrt(max(1 - x * x - y * y, 0.0)) * normals
        open_sky = ~caster.is_blocked(start, direction)
        total += open_sky * np.where(direction[:, 2] < 0, bounce, 1.0)
    return total / rays


def _disc(count: int) -> np.ndarray:
    """Spread points (count, 2) evenly over the unit disc, on a golden spiral."""
    index = np.arange(count) + 0.5
    radius, turn = np.sqrt(index / count), index * np.pi * (3 - np.sqrt(5))
    return np.column_stack([radius * np.cos(turn), radius * np.sin(turn)])


def _frame(axis: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two unit vectors across a unit axis."""
    helper = np.array([0.0, 0, 1]) if abs(axis[2]) < 0.9 else np.array([1.0, 0, 0])
    side = np.cross(helper, axis)
    side = side / np.linalg.norm(side)
    return side, np.cross(axis, side)
