"""Textures of supports and of things that lie around: tiles, stone, prints, pictures; as in `textures`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from threedfs.synthetic.noise import fractal_noise, hash_cells
from threedfs.synthetic.solid import Texture
from threedfs.synthetic.textures import Colour, fade, mix, photograph


def tiled(colour: Colour, joint: Colour, size: float, gap: float, seed: int = 0) -> Texture:
    """Make plain tiles `size` wide, joints `gap` wide: hardly any texture but faint clouds and a tone of their own."""

    def texture(points: np.ndarray, footprint: np.ndarray) -> np.ndarray:
        x, y = points[:, 0] / size, points[:, 1] / size
        tone = 1 + 0.05 * (hash_cells(np.floor(x), np.floor(y), seed=seed) - 0.5)
        cloud = 1 + 0.03 * fractal_noise(points, footprint, size / 2, 4, 0.5, seed + 1)
        edge = np.minimum(np.minimum(x % 1, 1 - x % 1), np.minimum(y % 1, 1 - y % 1)) * size
        # The joint's border is blended over a pixel; a joint narrower than a pixel keeps its share of it.
        wide = np.maximum(footprint, 0.0004)
        share = np.clip((gap / 2 - edge) / wide + 0.5, 0, 1) * np.minimum(gap / wide, 1)
        grit = 1 + 0.25 * fractal_noise(points, footprint, 0.004, 3, 0.7, seed + 2)
        return np.clip(
            mix(np.asarray(colour) * (tone * cloud)[:, None], np.asarray(joint) * grit[:, None], share), 0, 1
        )

    return texture


def stony(ground: Colour, veins: Colour, grains: Colour, size: float, seed: int = 0) -> Texture:
    """Make polished stone: clouds about `size` wide, thin veins between them, fine grains."""

    def texture(points: np.ndarray, footprint: np.ndarray) -> np.ndarray:
        bend = np.column_stack([fractal_noise(points, footprint, size, 3, 0.5, seed + k) for k in range(2)])
        moved = points + np.column_stack([bend, np.zeros(len(points))]) * 0.6 * size
        cloud = fractal_noise(moved, footprint, 1.5 * size, 5, 0.6, seed + 2)
        vein = 1 - np.clip(np.abs(fractal_noise(moved, footprint, size, 4, 0.5, seed + 3)) / 0.05, 0, 1)
        vein = 0.13 + (vein - 0.13) * fade(size / 4, footprint)  # veins cover about so much
        grain = np.clip(fractal_noise(points, footprint, 0.006, 3, 0.8, seed + 4) * 3 - 0.5, 0, 1)
        colour = mix(ground, np.asarray(ground) * 0.6, 0.5 + 1.4 * cloud)
        return np.clip(mix(mix(colour, veins, 0.7 * vein), grains, grain * fade(0.006, footprint)), 0, 1)

    return texture


def scattered(ground: Colour, palette: Sequence[Colour], size: float, seed: int = 0) -> Texture:
    """Make a printed cloth or paper: rings and dots of many sizes, up to `size`, in colours of the palette."""
    colours = np.asarray(palette, float)

    def texture(points: np.ndarray, footprint: np.ndarray) -> np.ndarray:
        cloth = 1 + 0.12 * fractal_noise(points, footprint, 0.15, 7, 0.7, seed)
        colour = np.tile(np.asarray(ground, float), (len(points), 1))
        for layer, (wide, turn) in enumerate(((size, 0.3), (size / 2.1, 1.1), (size / 3.7, 2.0))):
            own = seed + 10 * layer
            u = (np.cos(turn) * points[:, 0] + np.sin(turn) * points[:, 1]) / wide
            v = (np.cos(turn) * points[:, 1] - np.sin(turn) * points[:, 0]) / wide
            cell = (np.floor(u), np.floor(v))
            chance, radius, across, up, ink = (hash_cells(*cell, seed=own + k) for k in range(1, 6))
            radius = 0.12 + 0.33 * radius
            # The whole dot lies in its cell.
            centre_u, centre_v = radius + across * (1 - 2 * radius), radius + up * (1 - 2 * radius)
            off = np.hypot(u % 1 - centre_u, v % 1 - centre_v)
            off = np.where(chance > 0.75, np.abs(off - 0.75 * radius) + 0.75 * radius, off)
            inside = (radius - off) * wide
            share = np.clip(inside / np.maximum(footprint, 0.0003) + 0.5, 0, 1) * (chance > 0.3)
            visible = fade(wide / 3, footprint)
            colour = mix(colour, colours[(ink * len(colours)).astype(int)], 0.9 * share * visible)
            # From afar the dots, a sixth of the surface, melt into their mean.
            colour = mix(colour, colours.mean(axis=0), 0.15 * (1 - visible))
        return np.clip(colour * cloth[:, None], 0, 1)

    return texture


def pictured(half: Sequence[float], border: float, seed: int = 0) -> Texture:
    """Make a picture postcard with half sizes `half` and a white border, in its own x, y."""

    def texture(points: np.ndarray, footprint: np.ndarray) -> np.ndarray:
        picture = photograph(points, footprint, 1.2 * min(half), seed)
        inside = np.minimum(half[0] - np.abs(points[:, 0]), half[1] - np.abs(points[:, 1])) - border
        return mix((0.78, 0.77, 0.74), picture, np.clip(inside / np.maximum(footprint, 1e-12) + 0.5, 0, 1))

    return texture
