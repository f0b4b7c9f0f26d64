"""Textures: linear RGB as a function of position, faded where finer than a pixel.

Each maker returns a function of points (N, 3) and pixel footprints (N,), both in scene units (about
metres), that gives linear RGB (N, 3) in [0, 1].
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from threedfs.synthetic.noise import cell_noise, fractal_noise, hash_cells
from threedfs.synthetic.solid import Texture

Colour = Sequence[float]


def mix(a: Colour | np.ndarray, b: Colour | np.ndarray, share: np.ndarray) -> np.ndarray:
    """Blend colours: `a` where share (N,) is 0, `b` where it is 1."""
    share = np.clip(share, 0, 1)[:, None]
    return np.asarray(a) * (1 - share) + np.asarray(b) * share


def fade(wavelength: float, footprint: np.ndarray) -> np.ndarray:
    """Visibility (N,) of a pattern of that wavelength: 0 up to two footprints, where it would alias, 1 from four."""
    return np.clip(wavelength / np.maximum(footprint, 1e-12) / 2 - 1, 0, 1)


def plain(colour: Colour, mottle: float = 0.03, wavelength: float = 0.02, seed: int = 0) -> Texture:
    """Make a nearly uniform colour, varied by the relative amount `mottle`."""

    def texture(points: np.ndarray, footprint: np.ndarray) -> np.ndarray:
        shade = 1 + mottle * 2 * fractal_noise(points, footprint, wavelength, 4, 0.6, seed)
        return np.clip(np.asarray(colour) * shade[:, None], 0, 1)

    return texture


def speckled(a: Colour, b: Colour, size: float, cover: float, seed: int = 0) -> Texture:
    """Make irregular flecks of colour `b`, about `size` wide, on `cover` of the surface of colour `a`."""
    # The median absolute value of this noise is about 0.2: a threshold in its units sets the cover.
    threshold = 0.55 * (0.5 - cover)

    def texture(points: np.ndarray, footprint: np.ndarray) -> np.ndarray:
        value = fractal_noise(points, footprint, 2 * size, 3, 0.5, seed)
        fine = 1 + 0.2 * fractal_noise(points, footprint, size / 2, 3, 0.7, seed + 50)
        share = np.clip((value - threshold) / 0.12 + 0.5, 0, 1)
        share = cover + (share - cover) * fade(size, footprint)
        return np.clip(mix(a, b, share) * fine[:, None], 0, 1)

    return texture


def knitted(colour: Colour, fleck: Colour, stitch: float, seed: int = 0) -> Texture:
    """Make wool around the z axis: rows of stitches `stitch` high, each of another shade, some of colour `fleck`."""

    def texture(points: np.ndarray, footprint: np.ndarray) -> np.ndarray:
        angle = np.arctan2(points[:, 1], points[:, 0]) * 0.035
        wobble = 0.25 * fractal_noise(points, footprint, 6 * stitch, 2, 0.5, seed)
        row = points[:, 2] / stitch + wobble
        column = angle / stitch + wobble + 0.5 * np.floor(row)
        cell = hash_cells(np.floor(row), np.floor(column), seed=seed)
        pattern = fractal_noise(points, footprint, 0.02, 2, 0.5, seed + 9)
        flecked = (cell > 0.86 - 0.5 * pattern).astype(float)
        groove = 0.55 + 0.45 * np.sin(np.pi * (row % 1)) * np.sin(np.pi * (column % 1)) ** 0.5
        visible = fade(stitch, footprint)[:, None]
        near = mix(colour, fleck, flecked) * ((0.75 + 0.5 * cell) * (0.5 + groove * 0.65))[:, None]
        return np.clip(near * visible + mix(colour, fleck, np.full(len(points), 0.14)) * (1 - visible), 0, 1)

    return texture


def streaked(colour: Colour, groove: Colour, across: float, along: float, seed: int = 0) -> Texture:
    """Make hair: vertical strands `across` wide and `along` long."""

    def texture(points: np.ndarray, footprint: np.ndarray) -> np.ndarray:
        scaled = points / (across, across, along)
        value = fractal_noise(scaled, footprint / across, 2.0, 4, 0.6, seed)
        return np.clip(mix(colour, groove, 0.5 + 1.4 * value), 0, 1)

    return texture


def scaly(colour: Colour, groove: Colour, size: float, seed: int = 0) -> Texture:
    """Make scales of uneven shade, about `size` wide, lighter in the middle, with grooves between them."""

    def texture(points: np.ndarray, footprint: np.ndarray) -> np.ndarray:
        first, second, name = cell_noise(points, size, seed)
        raised = np.clip((second - first - 0.04) / 0.22, 0, 1) * (1.1 - 0.5 * first)
        wear = 1 + 0.5 * fractal_noise(points, footprint, 8 * size, 6, 0.75, seed + 10)
        visible = fade(size, footprint)
        share = 0.48 + (raised - 0.48) * visible  # its mean from afar
        shade = 1 + 0.9 * (name - 0.5) * visible
        return np.clip(mix(groove, colour, share) * (shade * wear)[:, None], 0, 1)

    return texture


def photograph(points: np.ndarray, footprint: np.ndarray, size: float, seed: int) -> np.ndarray:
    """Return something like a photograph, (N, 3): strong light and dark, muted colours, details of all sizes."""
    tone = fractal_noise(points, footprint, size, 7, 0.72, seed)
    warmth = fractal_noise(points, footprint, 1.5 * size, 3, 0.5, seed + 10)
    green = fractal_noise(points, footprint, 1.2 * size, 3, 0.5, seed + 20)
    light = np.clip(0.30 + 0.95 * tone, 0.015, 1)
    tint = 1 + np.column_stack([0.7 * warmth, 0.45 * green, -0.7 * warmth])
    return np.clip(light[:, None] * tint, 0.01, 0.95)


def wood(light: Colour, dark: Colour, plank: float, seed: int = 0) -> Texture:
    """Make planks along x, `plank` wide, with rings, fibres and pores."""

    def texture(points: np.ndarray, footprint: np.ndarray) -> np.ndarray:
        x, y = points[:, 0], points[:, 1]
        board = np.floor(y / plank)
        identity = hash_cells(board, seed=seed)
        shifted = x + 7.3 * identity
        joint_cell = np.floor(shifted / 0.83)
        shade = hash_cells(board, joint_cell, seed=seed + 1)
        # Another slice of the trunk for every board: the third coordinate differs.
        depth = 3.1 * board + 1.7 * joint_cell
        flow = np.column_stack([shifted / 5, y, depth])
        bend = fractal_noise(flow, footprint, 0.08, 3, 0.5, seed + 2)
        rings = y * 110 + 9 * bend + 0.8 * fractal_noise(flow, footprint, 0.02, 3, 0.6, seed + 3)
        ring = (rings + 17 * shade) % 1.0
        grain = np.where(ring < 0.8, ring / 0.8, (1 - ring) / 0.2)
        grain = 0.5 + (grain - 0.5) * fade(0.008, footprint)
        fibre = fractal_noise(np.column_stack([shifted / 14, y, depth]), footprint, 0.006, 4, 0.8, seed + 4)
        pores = fractal_noise(np.column_stack([shifted / 9, y, depth]), footprint, 0.003, 2, 0.8, seed + 5)
        stain = fractal_noise(points, footprint, 0.25, 6, 0.65, seed + 6)
        share = 0.18 + 0.42 * grain + 0.55 * fibre + 0.25 * (shade - 0.5) + 0.35 * stain
        share = share + 0.5 * np.clip(pores - 0.25, 0, 1) * 2
        gap = np.minimum(y / plank - board, 1 - (y / plank - board)) * plank
        end = np.minimum(shifted / 0.83 - joint_cell, 1 - (shifted / 0.83 - joint_cell)) * 0.83
        seam = np.clip(1.5 - np.minimum(gap, end) / 0.0008, 0, 1) * fade(0.003, footprint)
        return mix(mix(light, dark, share), (0.02, 0.012, 0.008), 0.8 * seam)

    return texture


def woven(warp: Colour, weft: Colour, thread: float, seed: int = 0) -> Texture:
    """Make plain-weave cloth of two threads, of uneven thickness and shade, with faint creases."""

    def texture(points: np.ndarray, footprint: np.ndarray) -> np.ndarray:
        wobble = fractal_noise(points, footprint, 0.04, 3, 0.5, seed)
        u, v = points[:, 0] / thread + wobble, points[:, 1] / thread - wobble
        over = (np.floor(u) + np.floor(v)) % 2
        tone_u = hash_cells(np.floor(u), np.floor(v / 60), seed=seed + 1)
        tone_v = hash_cells(np.floor(v), np.floor(u / 60), seed=seed + 2)
        tone = np.where(over == 0, tone_u, tone_v)
        near = mix(warp, weft, over) * (0.5 + tone)[:, None]
        slubs = 1 + 0.35 * fractal_noise(points * (0.15, 1, 1), footprint, 0.01, 4, 0.8, seed + 3)
        slubs += 0.35 * fractal_noise(points * (1, 0.15, 1), footprint, 0.01, 4, 0.8, seed + 4)
        crease = 1 + 0.25 * fractal_noise(points, footprint, 0.3, 5, 0.55, seed + 5)
        visible = fade(2 * thread, footprint)[:, None]
        far = (np.asarray(warp) + np.asarray(weft)) / 2
        return np.clip((near * visible + far * (1 - visible)) * (slubs * crease)[:, None], 0, 1)

    return texture


def printed(paper: Colour, ink: Colour, line: float, seed: int = 0) -> Texture:
    """Make a printed page in its own x, y: lines of glyphs `line` apart, headings, and pictures between."""

    def texture(points: np.ndarray, footprint: np.ndarray) -> np.ndarray:
        x, y = points[:, 0], points[:, 1]
        column = np.floor(x / (26 * line))
        block = np.floor(y / (9 * line))
        kind = hash_cells(column, block, seed=seed)
        scale = np.where(kind < 0.2, 3.0, 1.0)  # headings are set three times as large
        row = y / (line * scale)
        across = x / (line * scale * 0.62) + 9 * hash_cells(np.floor(row), column, seed=seed + 3)
        word = hash_cells(np.floor(across), np.floor(row), seed=seed + 1)
        strokes = hash_cells(np.floor(across * 4), np.floor(row * 7), np.floor(row), seed=seed + 2)
        in_glyph = ((across % 1) < 0.78) & ((row % 1) > 0.3) & (word > 0.17)
        glyph = (in_glyph & (strokes > 0.42)) * 1.0
        visible = fade(line * scale / 3, footprint)
        # From afar first strokes, then words melt into their mean: 58 % of a word is ink, 45 % of a block words.
        word_tone = 0.58 * (0.45 + (in_glyph - 0.45) * fade(line * scale, footprint))
        text = mix(paper, ink, glyph * visible + word_tone * (1 - visible))
        picture = photograph(points, footprint, 7 * line, seed + 20)
        margin = ((x / (26 * line)) % 1 > 0.06) & ((y / (9 * line)) % 1 > 0.05)
        is_picture = (kind > 0.68) & margin
        page = np.where(is_picture[:, None], picture, np.where(margin[:, None], text, np.asarray(paper)))
        return np.clip(page * (1 + 0.06 * fractal_noise(points, footprint, 0.1, 4, 0.6, seed + 7))[:, None], 0, 1)

    return texture
