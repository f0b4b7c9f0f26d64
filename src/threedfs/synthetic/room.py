"""The room around the table: far surfaces that give the horizon something to look at."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from threedfs.synthetic.light import Light
from threedfs.synthetic.noise import fractal_noise, hash_cells
from threedfs.synthetic.solid import Texture
from threedfs.synthetic.textures import fade, mix, photograph


@dataclass(frozen=True)
class Room:
    """A box seen from inside.

    Attributes
    ----------
    low, high : (3,) float
        Its corners, world; the floor is at low[2].
    floor : Texture
    wall_seed : int
        Selects the shelves, pictures and wallpaper of the walls.
    window : (3,) float
        Linear RGB of the daylight in the windows.
    """

    low: tuple[float, float, float]
    high: tuple[float, float, float]
    floor: Texture
    wall_seed: int = 0
    window: tuple[float, float, float] = (3.0, 3.3, 3.8)

    def radiance(self, points: np.ndarray, axis: np.ndarray, footprint: np.ndarray, light: Light) -> np.ndarray:
        """Return linear RGB (N, 3) of points on its inside; `axis` (N,) is the axis their wall is across."""
        normals = np.zeros_like(points)
        middle = (np.asarray(self.low) + self.high) / 2
        rows = np.arange(len(points))
        normals[rows, axis] = np.where(points[rows, axis] < middle[axis], 1.0, -1.0)
        colour = np.full((len(points), 3), 0.75)
        emitted = np.zeros((len(points), 3))
        floor = np.flatnonzero((axis == 2) & (normals[:, 2] > 0))
        colour[floor] = self.floor(points[floor], footprint[floor])
        for side in range(2):
            wall = np.flatnonzero(axis == side)
            along, height = points[wall, 1 - side], points[wall, 2] - self.low[2]
            # Each of the four walls continues on its own stretch of pattern.
            along = along + 20 * side + 50 * (normals[wall, side] > 0)
            colour[wall], emitted[wall] = self._wall(along, height, footprint[wall])
        return colour * (light.irradiance(points, normals) + 0.8 * np.asarray(light.ambient)) + emitted

    def _wall(self, along: np.ndarray, height: np.ndarray, footprint: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Colour and emission (N, 3) of the walls: bays of shelves, pictures or a window over a skirting."""
        seed = self.wall_seed
        bay_width = 1.15
        bay = np.floor(along / bay_width)
        x = (along / bay_width - bay) * bay_width
        kind = hash_cells(bay, seed=seed)
        place = np.column_stack([along, height, np.zeros_like(along)])
        paper = 0.62 + 0.10 * fractal_noise(place, footprint, 0.5, 6, 0.6, seed + 1)
        colour = mix((0.9, 0.85, 0.74), (0.55, 0.62, 0.6), hash_cells(bay // 3, seed=seed + 2)) * paper[:, None]
        emitted = np.zeros_like(colour)

        # Each pattern is made only where it shows.
        framed = (kind >= 0.45) & (kind < 0.8) & (np.abs(x - 0.57) < 0.36) & (np.abs(height - 1.15) < 0.45)
        inner = np.flatnonzero(framed & (np.abs(x - 0.57) < 0.31) & (np.abs(height - 1.15) < 0.40))
        shelves = np.flatnonzero((kind < 0.45) & (height < 1.9) & (x > 0.03) & (x < bay_width - 0.03))
        pane = (kind >= 0.8) & (np.abs(x - 0.57) < 0.42) & (height > 0.85) & (height < 2.1)
        pane = np.flatnonzero(pane & (np.abs(x - 0.57) > 0.02) & (np.abs(height - 1.45) > 0.02))
        colour[shelves] = self._books(along[shelves], height[shelves], bay[shelves], footprint[shelves])
        colour[framed] = (0.1, 0.07, 0.05)
        colour[inner] = photograph(place[inner], footprint[inner], 0.28, seed + 10)
        sky = 0.75 + 0.4 * fractal_noise(place[pane], footprint[pane], 0.7, 5, 0.6, seed + 15)
        emitted[pane] = sky[:, None] * np.asarray(self.window)
        colour = np.where((height < 0.09)[:, None], (0.8, 0.78, 0.74), colour)
        return colour, emitted

    def _books(self, along: np.ndarray, height: np.ndarray, bay: np.ndarray, footprint: np.ndarray) -> np.ndarray:
        """Colour (N, 3) of shelves full of books."""
        seed = self.wall_seed
        shelf = np.floor(height / 0.36)
        book_cell = np.floor(along / 0.045 + 3 * hash_cells(shelf, bay, seed=seed + 3))
        hue = np.stack([hash_cells(book_cell, shelf, seed=seed + 4 + c) for c in range(3)], axis=-1)
        top = 0.2 + 0.13 * hash_cells(book_cell, shelf, seed=seed + 8)
        level = height - 0.36 * shelf
        # Spines: dark or light cloth, weakly coloured, some with a pale label at their own height.
        spine = (0.05 + 0.45 * hash_cells(book_cell, shelf, seed=seed + 9) ** 2)[:, None] * (0.45 + 0.9 * hue)
        label_level = 0.08 + 0.10 * hue[:, 0]
        label = (np.abs(level - label_level) < 0.02) & (hue[:, 1] > 0.5)
        spine = np.where(label[:, None], 0.55, spine)
        books = np.where((level < top)[:, None], spine, 0.03)
        books = np.where((level > 0.335)[:, None], (0.35, 0.24, 0.14), books)
        visible = fade(0.045, footprint)[:, None]
        return books * visible + 0.18 * (1 - visible)
