"""Rendering a scene: exact depth and mask, and the light that reaches each pixel."""

from __future__ import annotations

import numpy as np

from threedfs.errors import UserError
from threedfs.geometry.projection import pixel_grid, project
from threedfs.geometry.raycast import Hits, RayCaster
from threedfs.geometry.vectors import dot, normalise
from threedfs.synthetic.scene import Scene
from threedfs.synthetic.shadow import CastLight
from threedfs.synthetic.table import enter_box
from threedfs.types import Box, View

# Supersampling resolves a little more than the pixel: textures keep detail down to this share of it.
_FOOTPRINT = 0.7


class Renderer:
    """Renders one scene from any view.

    Shadows and ambient occlusion do not depend on the view: they are cast once, when it is made.

    Parameters
    ----------
    scene : Scene
    shadow_rays, ambient_rays : int
        Rays per point to the lamp and to all sides.
    shadow_spacing : float
        Spacing of the grid on the table that holds the shadow, scene units.
    """

    def __init__(
        self, scene: Scene, shadow_rays: int = 64, ambient_rays: int = 96, shadow_spacing: float = 0.003
    ) -> None:
        self.scene = scene
        self._caster = RayCaster(scene.solid.mesh)
        self._light = CastLight(scene, self._caster, shadow_rays, ambient_rays, shadow_spacing)

    def depth(self, view: View) -> np.ndarray:
        """Return the exact depth (H, W) float64 of whatever each pixel's centre sees, scene units."""
        return self.measure(view)[0]

    def mask(self, view: View) -> np.ndarray:
        """Return (H, W) bool: pixels whose centre sees the object."""
        return self.measure(view)[1]

    def measure(self, view: View) -> tuple[np.ndarray, np.ndarray]:
        """Return `depth` and `mask` of a view."""
        origins, directions = self._rays(view)
        on_object = self._cast_object(view, origins, directions).distance
        on_rest = self._cast_rest(origins, directions)[0]
        shape = view.camera.shape
        return np.minimum(on_object, on_rest).reshape(shape), (on_object < on_rest).reshape(shape)

    def radiance(self, view: View, shift: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
        """Return the linear RGB (H, W, 3) float64 seen `shift` (u, v) pixels beside the pixel centres."""
        return self.look(view, shift)[0]

    def look(self, view: View, shift: tuple[float, float] = (0.0, 0.0)) -> tuple[np.ndarray, np.ndarray]:
        """Return `radiance` and the depth (H, W) float64 of what is seen there."""
        origins, directions = self._rays(view, shift)
        hits = self._cast_object(view, origins, directions)
        spread = _FOOTPRINT / view.camera.fx
        colour, distance = self._see_rest(origins, directions, spread)
        shown = np.flatnonzero(hits.distance < distance)
        colour[shown] = self._shade_object(
            origins[shown],
            directions[shown],
            Hits(hits.triangle[shown], hits.distance[shown], hits.weights[shown]),
            spread,
        )
        depth = np.minimum(hits.distance, distance)
        return colour.reshape(*view.camera.shape, 3), depth.reshape(view.camera.shape)

    def _rays(self, view: View, shift: tuple[float, float] = (0.0, 0.0)) -> tuple[np.ndarray, np.ndarray]:
        """Return the rays of a view that stands inside the room.

        Raises
        ------
        UserError
            If the camera has left the room, from where there is nothing to see.
        """
        room = self.scene.room
        if not np.all((view.centre > room.low) & (view.centre < room.high)):
            raise UserError(
                f"Frame {view.name}: expected the camera inside the room {room.low} to {room.high}, got it at "
                f"{view.centre.round(3)}; bring the path nearer or enlarge the room."
            )
        return pixel_rays(view, shift)

    def _cast_object(self, view: View, origins: np.ndarray, directions: np.ndarray) -> Hits:
        """Cast only the rays inside the projected bounding box of the object."""
        vertices = self.scene.solid.mesh.vertices
        low, high = vertices.min(axis=0), vertices.max(axis=0)
        pixels, depth = project(view, Box(np.eye(3), low, high).corners())
        if np.all(depth > 0):
            u, v = pixel_grid(view.camera)
            near = (u >= pixels[:, 0].min() - 2) & (u <= pixels[:, 0].max() + 2)
            near &= (v >= pixels[:, 1].min() - 2) & (v <= pixels[:, 1].max() + 2)
            cast = np.flatnonzero(near)
        else:
            cast = np.arange(len(directions))
        found = self._caster.first_hits(origins[cast], directions[cast])
        triangle = np.full(len(directions), -1)
        distance = np.full(len(directions), np.inf)
        weights = np.zeros((len(directions), 3))
        triangle[cast], distance[cast], weights[cast] = found.triangle, found.distance, found.weights
        return Hits(triangle, distance, weights)

    def _cast_rest(self, origins: np.ndarray, directions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Meet table and room; return distance (N,), whether it is the table (N,), and the axis of the face."""
        table, room = self.scene.table, self.scene.room
        half = np.asarray(table.half)
        entry, _, table_axes = enter_box(
            origins, directions, np.array([*-half, -table.thickness]), np.array([*half, 0.0])
        )
        _, leave, room_axes = enter_box(origins, directions, np.asarray(room.low), np.asarray(room.high))
        on_table = entry < leave
        return np.where(on_table, entry, leave), on_table, np.where(on_table, table_axes[0], room_axes[1])

    def _see_rest(self, origins: np.ndarray, directions: np.ndarray, spread: float) -> tuple[np.ndarray, np.ndarray]:
        """Return linear RGB (N, 3) of table or room along rays that widen by `spread` per distance, and the
        distance (N,) to it."""
        scene, light = self.scene, self.scene.light
        distance, on_table, axis = self._cast_rest(origins, directions)
        points = origins + distance[:, None] * directions
        rows = np.arange(len(points))
        length = np.sqrt(dot(directions, directions))
        cosine = np.maximum(np.abs(directions[rows, axis]) / length, 0.05)
        footprint = distance * spread / np.sqrt(cosine)
        colour = np.empty((len(points), 3))
        far, top = np.flatnonzero(~on_table), np.flatnonzero(on_table)
        colour[far] = scene.room.radiance(points[far], axis[far], footprint[far], light)

        where, face = points[top], axis[top]
        where[face == 2, 2] = 0.0
        normals = np.zeros_like(where)
        normals[np.arange(len(top)), face] = -np.sign(directions[top, face])
        albedo, gloss = scene.table.albedo(where, footprint[top])
        lamp, ambient = self._light.on_table(where)
        to_eye = -directions[top] / length[top, None]
        colour[top] = albedo * (
            lamp[:, None] * light.irradiance(where, normals) + ambient[:, None] * np.asarray(light.ambient)
        ) + (gloss[:, 0] * lamp)[:, None] * light.highlight(where, normals, to_eye, gloss[:, 1])
        return colour, distance

    def _shade_object(self, origins: np.ndarray, directions: np.ndarray, hits: Hits, spread: float) -> np.ndarray:
        """Return linear RGB (N, 3) of the object's surface where rays hit it."""
        solid, light = self.scene.solid, self.scene.light
        corners = solid.mesh.faces[hits.triangle]
        points = origins + hits.distance[:, None] * directions
        normals = normalise(np.einsum("nk,nkc->nc", hits.weights, solid.normals[corners]))
        lamp, ambient = np.einsum("nk,nkc->cn", hits.weights, self._light.at_vertices[corners])
        to_eye = -normalise(directions)
        facing = np.abs(dot(to_eye, normals))
        footprint = hits.distance * spread / np.sqrt(np.maximum(facing, 0.1))
        diffuse = lamp[:, None] * light.irradiance(points, normals) + ambient[:, None] * np.asarray(light.ambient)
        material_of = solid.material_of(points)
        colour = np.zeros((len(points), 3))
        for index, material in enumerate(solid.materials):
            on = np.flatnonzero(material_of == index)
            if len(on) == 0:
                continue
            colour[on] = material.texture(points[on], footprint[on]) * diffuse[on]
            if material.specular > 0:
                lobe = light.highlight(points[on], normals[on], to_eye[on], material.shininess)
                colour[on] += material.specular * lamp[on, None] * lobe
            if material.mirror > 0:
                reflected = 2 * dot(to_eye[on], normals[on])[:, None] * normals[on] - to_eye[on]
                # Schlick's approximation; what the object itself blocks stays dark by its ambient share.
                share = material.mirror + (1 - material.mirror) * (1 - facing[on]) ** 5
                start = points[on] + [0, 0, 2e-3]  # clear of the table that the object stands on
                seen, _ = self._see_rest(start, reflected, 1 / material.shininess)
                colour[on] += (share * ambient[on])[:, None] * np.minimum(seen, 4.0)
        return colour


def pixel_rays(view: View, shift: tuple[float, float] = (0.0, 0.0)) -> tuple[np.ndarray, np.ndarray]:
    """Return origins and directions (H*W, 3), world, of the rays through all pixels in row order.

    Directions have depth 1, so that a distance in their lengths is a depth.
    """
    camera = view.camera
    u, v = pixel_grid(camera)
    x = (u + shift[0] - camera.cx) / camera.fx
    y = (v + shift[1] - camera.cy) / camera.fy
    in_camera = np.stack([x, y, np.ones_like(x)], axis=-1).reshape(-1, 3)
    # Not a matrix product: its threads would fight with those of the other frames' processes.
    directions = np.einsum("nc,cw->nw", in_camera, view.cam_from_world[:3, :3])
    return np.broadcast_to(view.centre, directions.shape), directions
