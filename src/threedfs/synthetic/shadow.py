"""Light that does not depend on the view, cast once: shadows and ambient occlusion on object and table."""

from __future__ import annotations

import numpy as np

from threedfs.geometry.raycast import RayCaster
from threedfs.synthetic.light import lamp_visibility, openness
from threedfs.synthetic.scene import Scene

# Share of the ambient light that the table throws back up at the object.
_TABLE_BOUNCE = 0.45


class CastLight:
    """What the object leaves of the light of a scene, for itself and for the table.

    Parameters
    ----------
    scene : Scene
    caster : RayCaster
        Of the object's mesh.
    shadow_rays, ambient_rays : int
        Rays per point to the lamp and to all sides.
    spacing : float
        Spacing of the table's grid, scene units.

    Attributes
    ----------
    at_vertices : (V, 2) float64
        Visible share of the lamp and open share of the surroundings at the object's vertices.
    """

    def __init__(self, scene: Scene, caster: RayCaster, shadow_rays: int, ambient_rays: int, spacing: float) -> None:
        mesh, normals, light = scene.solid.mesh, scene.solid.normals, scene.light
        # Rays start a little above the surface, so that they do not meet the triangle they leave.
        offset = 1e-3 * float(np.ptp(mesh.vertices, axis=0).max())
        self.at_vertices = np.column_stack(
            [
                lamp_visibility(caster, light, mesh.vertices, normals, shadow_rays, offset),
                openness(caster, mesh.vertices, normals, ambient_rays, offset, _TABLE_BOUNCE),
            ]
        )
        self._low, shape = _shadow_grid(scene, spacing)
        self._spacing = spacing
        x, y = (self._low[d] + spacing * np.arange(shape[d]) for d in range(2))
        points = np.stack([*np.meshgrid(x, y, indexing="ij"), np.zeros(shape)], axis=-1).reshape(-1, 3)
        up = np.broadcast_to([0.0, 0.0, 1.0], points.shape)
        self._map = np.stack(
            [
                lamp_visibility(caster, light, points, up, shadow_rays, offset).reshape(shape),
                openness(caster, points, up, ambient_rays, offset, 0.0).reshape(shape),
            ]
        )

    def on_table(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return visible share of the lamp and open share of the surroundings (N,) at points (N, 3) of the table."""
        grid = (points[:, :2] - self._low) / self._spacing
        inside = [(grid[:, d] >= 0) & (grid[:, d] < self._map.shape[1 + d] - 1) for d in range(2)]
        on = np.flatnonzero(inside[0] & inside[1] & (points[:, 2] > -1e-6))
        cell = grid[on].astype(int)
        a, b = (grid[on] - cell).T
        i, j = cell.T
        corner = self._map
        value = np.ones((2, len(points)))  # off the grid nothing is shaded
        value[:, on] = (1 - a) * ((1 - b) * corner[:, i, j] + b * corner[:, i, j + 1]) + a * (
            (1 - b) * corner[:, i + 1, j] + b * corner[:, i + 1, j + 1]
        )
        return value[0], value[1]


def _shadow_grid(scene: Scene, spacing: float) -> tuple[np.ndarray, np.ndarray]:
    """Lay a grid on the table around the whole shadow: its low corner (2,) and its shape (2,)."""
    vertices, light = scene.solid.mesh.vertices, scene.light
    lamp = np.asarray(light.position)
    rise = np.maximum(lamp[2] - light.radius - vertices[:, 2:], 1e-3)
    reach = vertices[:, 2:] / rise
    thrown = vertices[:, :2] + (vertices[:, :2] - lamp[:2]) * reach
    margin = float(vertices[:, 2].max()) + light.radius * float(reach.max())
    ends = np.concatenate([vertices[:, :2], thrown])
    half = np.asarray(scene.table.half)
    low, high = np.maximum(ends.min(0) - margin, -half), np.minimum(ends.max(0) + margin, half)
    return low, np.ceil((high - low) / spacing).astype(int) + 1
