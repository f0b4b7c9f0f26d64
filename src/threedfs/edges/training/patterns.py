"""Tiles of texture: what a contour detector must learn to look over."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from threedfs.synthetic import surfaces, textures

TILE = 384
"""Side of a tile, pixels."""


def make_tiles(count: int, rng: np.random.Generator) -> list[np.ndarray]:
    """Make tiles of all kinds in turn, (TILE, TILE, 3) float32 of mean 0 and standard deviation 1."""
    makers = (
        _noise, _strokes, _clutter, _noise, _stripes, _cells, _clutter, _weave, _strokes, _glyphs, _noise, _material,
        _clutter, _grid, _dots,
    )  # fmt: skip
    tiles = []
    for index in range(count):
        tile = makers[index % len(makers)](rng).astype(np.float32)
        if tile.ndim == 2:
            tile = tile[..., None] * (1 + 0.25 * rng.standard_normal(3)).astype(np.float32)
        tile = cv2.GaussianBlur(tile, (0, 0), float(rng.uniform(0.5, 1.2)))
        tiles.append((tile - tile.mean((0, 1))) / max(float(tile.std()), 1e-3))
    return tiles


def _spectrum(rng, exponent, stretch=1.0, angle=0.0):
    """Noise (TILE, TILE) whose amplitude falls with frequency to the given power, stretched along a direction."""
    v, u = np.meshgrid(np.fft.fftfreq(TILE), np.fft.rfftfreq(TILE), indexing="ij")
    along, across = u * np.cos(angle) + v * np.sin(angle), v * np.cos(angle) - u * np.sin(angle)
    frequency = np.sqrt((along * stretch) ** 2 + (across / stretch) ** 2)
    frequency[0, 0] = 1
    amplitude = np.maximum(frequency, 1 / TILE) ** -exponent
    amplitude[0, 0] = 0
    white = np.fft.rfft2(rng.standard_normal((TILE, TILE)))
    noise = np.fft.irfft2(white * amplitude, s=(TILE, TILE))
    return noise / noise.std()


def _noise(rng):
    stretch = float(np.exp(rng.normal(0, 0.5)))
    exponent, angle = rng.uniform(0.3, 1.7), rng.uniform(0, np.pi)
    grey = _spectrum(rng, exponent, stretch, angle)
    if rng.random() < 0.35:  # flecks with hard edges
        grey = np.tanh(4 * (grey - rng.uniform(-0.7, 0.7)))
    tint = np.dstack([_spectrum(rng, exponent, stretch, angle) for _ in range(3)])
    return grey[..., None] + rng.uniform(0, 0.5) * tint


def _places(rng, count):
    return rng.uniform(-20, TILE + 20, (count, 2))


def _shades(rng, count):
    grey = rng.standard_normal(count)
    return grey[:, None] + rng.uniform(0, 0.6) * rng.standard_normal((count, 3))


def _strokes(rng):
    """Hair, grass or needles: short lines about one direction."""
    length, width = float(np.exp(rng.uniform(np.log(6), np.log(50)))), int(rng.integers(1, 4))
    count = int(2.5 * TILE * TILE / (length * (width + 1)))
    direction, scatter = rng.uniform(0, np.pi), rng.uniform(0.05, 1.2)
    tile = np.zeros((TILE, TILE, 3), np.float32)
    drift = 0.6 * _spectrum(rng, 2.0)
    for (x, y), shade in zip(_places(rng, count), _shades(rng, count), strict=True):
        angle = direction + scatter * rng.standard_normal()
        angle += drift[int(np.clip(y, 0, TILE - 1)), int(np.clip(x, 0, TILE - 1))]
        dx, dy = length / 2 * np.cos(angle), length / 2 * np.sin(angle)
        ends = [(round(float(x + s * dx) * 8), round(float(y + s * dy) * 8)) for s in (-1, 1)]
        cv2.line(tile, *ends, shade.tolist(), width, cv2.LINE_AA, 3)
    return tile


def _clutter(rng):
    """Leaves, gravel or crowds: small ellipses or polygons over each other."""
    size = float(np.exp(rng.uniform(np.log(2.0), np.log(9))))
    count = int(min(1.6 * TILE * TILE / size**2, 25000))
    flat, spread, pointed = rng.uniform(0.3, 1), rng.uniform(0, 0.6), rng.random() < 0.4
    tile = np.zeros((TILE, TILE, 3), np.float32)
    for (x, y), shade in zip(_places(rng, count), _shades(rng, count), strict=True):
        radius = size * float(np.exp(spread * rng.standard_normal()))
        if pointed:
            angles = np.sort(rng.uniform(0, 2 * np.pi, int(rng.integers(3, 6))))
            corners = np.column_stack([x + radius * np.cos(angles), y + radius * np.sin(angles)])
            cv2.fillPoly(tile, [np.rint(corners * 8).astype(np.int32)], shade.tolist(), cv2.LINE_AA, 3)
        else:
            axes = (max(round(radius * 8), 8), max(round(radius * flat * 8), 8))
            turn = float(rng.uniform(0, 360))
            cv2.ellipse(tile, (round(x * 8), round(y * 8)), axes, turn, 0, 360, shade.tolist(), -1, cv2.LINE_AA, 3)
    return tile


def _warped(rng, strength):
    """Coordinates (TILE, TILE) along and across a random direction, bent by smooth noise of `strength` pixels."""
    y, x = np.mgrid[:TILE, :TILE].astype(np.float64)
    angle = rng.uniform(0, np.pi)
    u, v = x * np.cos(angle) + y * np.sin(angle), y * np.cos(angle) - x * np.sin(angle)
    return u + strength * _spectrum(rng, 2.0), v + strength * _spectrum(rng, 2.0)


def _stripes(rng):
    """Wood, zebra or fluting: bent bands of uneven shade."""
    period = float(np.exp(rng.uniform(np.log(4), np.log(40))))
    u, _ = _warped(rng, period * rng.uniform(0, 1.5))
    wave = np.sin(2 * np.pi * u / period) + 0.5 * np.sin(2 * np.pi * u / period / rng.uniform(2, 4) + 1)
    sharp = np.exp(rng.uniform(-1, 2))
    return np.tanh(sharp * wave) + rng.uniform(0.1, 0.8) * _spectrum(rng, rng.uniform(0.3, 1.2))


def _cells(rng):
    """Stones, scales or cracked earth: cells about random points, each of its own shade, with or without joints."""
    count = int(rng.integers(100, 3000))
    places = rng.uniform(0, TILE, (count, 2))
    seeds = np.ones((TILE, TILE), np.uint8)
    seeds[places[:, 1].astype(int), places[:, 0].astype(int)] = 0
    distance, label = cv2.distanceTransformWithLabels(seeds, cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL)
    shade = _shades(rng, int(label.max()) + 1)[label]
    typical = TILE / np.sqrt(count)
    return rng.uniform(0, 1) * shade + rng.uniform(-1.5, 1.5) * (distance / typical)[..., None]


def _weave(rng):
    period = float(np.exp(rng.uniform(np.log(3), np.log(16))))
    u, v = _warped(rng, period * rng.uniform(0, 0.6))
    u, v = u / period, v / period
    over = (np.floor(u) + np.floor(v)) % 2
    thread = np.where(over > 0, np.sin(np.pi * (u % 1)), np.sin(np.pi * (v % 1)))
    return rng.uniform(0, 1.5) * over + thread + rng.uniform(0, 0.6) * rng.standard_normal((TILE, TILE))


def _glyphs(rng):
    """Lines of strokes, like writing."""
    height = float(np.exp(rng.uniform(np.log(6), np.log(28))))
    u, v = _warped(rng, rng.uniform(0, 3))
    line, column = np.floor(v / height), np.floor(u / (0.6 * height))
    table = rng.random((64, 64, 7, 4)) < 0.55
    row, stroke = np.floor(v / height % 1 * 7).astype(int), np.floor(u / (0.6 * height) % 1 * 4).astype(int)
    ink = table[line.astype(int) % 64, column.astype(int) % 64, row, stroke]
    ink &= (row < 5) & (stroke < 3)
    return ink * float(rng.choice([-1.0, 1.0]))


def _grid(rng):
    """Bricks, tiles or windows."""
    wide, high = np.exp(rng.uniform(np.log(6), np.log(40), 2))
    u, v = _warped(rng, rng.uniform(0, 2))
    row = np.floor(v / high)
    u = u / wide + (row % 2) / 2 * (rng.random() < 0.5)
    gap = rng.uniform(0.05, 0.3)
    inside = (u % 1 > gap * min(high / wide, 1)) & (v / high % 1 > gap * min(wide / high, 1))
    table = rng.standard_normal((97, 89))
    shade = table[row.astype(int) % 97, np.floor(u).astype(int) % 89]
    return inside * (1.5 + rng.uniform(0, 1) * shade) + 0.3 * _spectrum(rng, 0.8)


def _dots(rng):
    period = float(np.exp(rng.uniform(np.log(5), np.log(30))))
    u, v = _warped(rng, period * rng.uniform(0, 0.8))
    radius = np.hypot(u % period - period / 2, v % period - period / 2) / period
    return np.tanh((rng.uniform(0.2, 0.4) - radius) * rng.uniform(5, 25)) + 0.2 * _spectrum(rng, 0.8)


def _material(rng):
    """One of the renderer's materials, seen from straight above."""
    seed = int(rng.integers(1 << 20))
    colours: Sequence = [tuple(rng.uniform(0.05, 0.8, 3)) for _ in range(4)]
    a, b, c, _ = colours
    makers = (
        lambda: textures.wood(a, b, 0.1, seed),
        lambda: textures.woven(a, b, 0.003, seed),
        lambda: textures.printed(a, b, 0.009, seed),
        lambda: textures.speckled(a, b, 0.012, 0.4, seed),
        lambda: textures.scaly(a, b, 0.02, seed),
        lambda: surfaces.stony(a, b, c, 0.02, seed),
        lambda: surfaces.scattered(a, colours[1:], 0.02, seed),
    )
    texture = makers[int(rng.integers(len(makers)))]()
    y, x = np.mgrid[:TILE, :TILE].reshape(2, -1) * float(rng.uniform(0.0005, 0.0016))
    points = np.column_stack([x, y, np.zeros_like(x)])
    colour = texture(points, np.full(len(points), x[1] - x[0]))
    return np.sqrt(np.clip(colour, 0, None)).reshape(TILE, TILE, 3)
