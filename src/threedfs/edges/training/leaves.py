"""Pictures of overlapping shapes: "dead leaves" with texture, shading, shadows, blur, noise and compression."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from threedfs.edges.training.picture import Picture, link_segments

_FINE = 2  # pictures are painted at twice their size and averaged


def paint_leaves(height: int, width: int, tiles: Sequence[np.ndarray], rng: np.random.Generator) -> Picture:
    """Paint shapes over each other, and record them as a camera would.

    Parameters
    ----------
    height, width : int
    tiles : sequence of (T, T, 3) float32
        Textures, as `make_tiles` makes them.
    rng : Generator
    """
    shape = (height * _FINE, width * _FINE)
    palette = _draw_palette(rng)
    canvas = _surface(shape, palette, tiles, rng)
    segments = np.zeros(shape, np.int32)
    count = int(np.exp(rng.uniform(np.log(3), np.log(45))))
    largest = rng.uniform(0.4, 1.0) * max(shape)
    smallest = rng.uniform(0.03, 0.12) * max(shape)
    # Large shapes lie behind small ones as a rule, not always.
    sizes = smallest * (largest / smallest) ** (rng.random(count) ** 1.3)
    sizes = sizes[np.argsort(-sizes * np.exp(0.5 * rng.standard_normal(count)))]
    for index, size in enumerate(sizes, start=1):
        if index <= 2 and rng.random() < 0.5:
            inside = _side_of_line(shape, rng)
        else:
            inside = _draw_shape(shape, size, rng)
        _lay(canvas, segments, inside, index, _surface(shape, palette, tiles, rng, inside), rng)
    canvas *= _shadows(shape, rng)
    image = cv2.resize(canvas, (width, height), interpolation=cv2.INTER_AREA)
    return Picture(record(image, rng), *link_segments(segments[::_FINE, ::_FINE]))


def record(image: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Blur, tone, disturb and compress an image (H, W, 3) float32 in [0, 1]; return uint8."""
    image = cv2.GaussianBlur(image, (0, 0), float(rng.uniform(0.3, 1.1)))
    image = np.clip(image, 0, 1) ** float(np.exp(rng.normal(0, 0.2)))
    if rng.random() < 0.1:
        image = np.repeat(image.mean(axis=-1, keepdims=True), 3, axis=-1)
    deviation = rng.uniform(0, 0.03) if rng.random() < 0.7 else 0.0
    image = image + deviation * rng.standard_normal(image.shape)
    encoded = np.rint(np.clip(image, 0, 1) * 255).astype(np.uint8)
    if rng.random() < 0.8:
        quality = int(rng.integers(45, 97))
        packed = cv2.imencode(".jpg", encoded[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, quality])[1]
        encoded = np.ascontiguousarray(cv2.imdecode(packed, cv2.IMREAD_COLOR)[..., ::-1])
    return encoded


def _draw_palette(rng):
    """Draw the colours (K, 3) of a picture: a few hues, mostly faint, dark to light."""
    count = int(rng.integers(3, 9))
    hue = rng.uniform(0, 2 * np.pi) + rng.choice([0.3, 1.0, 3.0]) * rng.standard_normal(count)
    chroma = 0.25 * rng.beta(1.2, 3, count)
    grey = rng.beta(1.3, 1.5, count)
    turns = np.array([0, 2 * np.pi / 3, 4 * np.pi / 3])
    return np.clip(grey[:, None] * (1 + 2 * chroma[:, None] * np.cos(hue[:, None] - turns)), 0.01, 1)


def _surface(shape, palette, tiles, rng, inside=None):
    """Paint a surface (H, W, 3) float32; where `inside` is given, only the window around it, as `_bounds` has it."""
    top, bottom, left, right = _bounds(inside, shape)
    height, width = bottom - top, right - left
    colour = palette[rng.integers(len(palette))] * np.exp(0.15 * rng.standard_normal(3) + 0.25 * rng.standard_normal())
    part = np.broadcast_to(np.log(np.clip(colour, 0.01, 1)).astype(np.float32), (height, width, 3)).copy()
    for _ in range(int(rng.choice([0, 1, 1, 1, 2]))):
        tile = tiles[rng.integers(len(tiles))]
        scale = _FINE * float(np.exp(rng.uniform(np.log(0.5), np.log(1.6))))
        angle = rng.uniform(0, 2 * np.pi)
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]) / scale
        if rng.random() < 0.3:  # seen at a slant
            turn[1] *= rng.uniform(1, 3)
        where = np.column_stack([turn, rng.uniform(0, tile.shape[0], 2)])
        seen = cv2.warpAffine(
            tile, where, (width, height), flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP, borderMode=cv2.BORDER_REFLECT
        )
        contrast = float(np.exp(rng.uniform(np.log(0.02), np.log(0.7))))
        tint = np.array([1, 1, 1]) + rng.uniform(0, 0.5) * rng.standard_normal(3)
        part += seen * (contrast * tint).astype(np.float32)
    part += _smooth_shade(height, width, rng)[..., None]
    return np.exp(np.clip(part, -5, 0.3))


def _smooth_shade(height, width, rng):
    """Slow changes (H, W) of the logarithm of brightness: a gradient, and stains."""
    y, x = np.mgrid[:height, :width].astype(np.float32)
    angle, strength = rng.uniform(0, 2 * np.pi), rng.exponential(0.25)
    shade = strength * ((x / width - 0.5) * np.cos(angle) + (y / height - 0.5) * np.sin(angle))
    coarse = rng.standard_normal(tuple(rng.integers(2, 7, 2))).astype(np.float32)
    return (shade + rng.exponential(0.12) * cv2.resize(coarse, (width, height), interpolation=cv2.INTER_CUBIC)).astype(
        np.float32
    )


def _bounds(inside, shape):
    if inside is None:
        return 0, shape[0], 0, shape[1]
    x, y, width, height = cv2.boundingRect(inside)
    margin = 12
    return (
        max(y - margin, 0),
        min(max(y + height + margin, 1), shape[0]),
        max(x - margin, 0),
        min(max(x + width + margin, 1), shape[1]),
    )


def _side_of_line(shape, rng):
    """Everything on one side of a wavy line, (H, W) uint8: a horizon or a wall."""
    height, width = shape
    angle = rng.choice([0.0, 0.0, np.pi / 2, rng.uniform(0, np.pi)]) + 0.1 * rng.standard_normal()
    y, x = np.mgrid[:height, :width].astype(np.float32)
    along = x * np.cos(angle) + y * np.sin(angle)
    across = (y - height * rng.uniform(0.2, 0.8)) * np.cos(angle) - (x - width * rng.uniform(0.2, 0.8)) * np.sin(angle)
    for _ in range(4):
        period = float(np.exp(rng.uniform(np.log(20), np.log(600))))
        across = across + rng.exponential(0.03) * period * np.sin(2 * np.pi * along / period + rng.uniform(0, 6))
    return (across > 0).astype(np.uint8)


def _draw_shape(shape, size, rng):
    """Draw a blob, ellipse, polygon, bar or fork of about that size, (H, W) uint8."""
    height, width = shape
    centre = rng.uniform(-0.05, 1.05, 2) * (width, height)
    flat = float(np.exp(-abs(rng.normal(0, 0.6))))
    kind = rng.random()
    if kind < 0.4:  # blob
        angles = np.linspace(0, 2 * np.pi, 180, endpoint=False)
        radius = np.ones_like(angles)
        for order in range(2, 12):
            radius += 0.5 / order * rng.normal(0, 0.8) * np.cos(order * angles + rng.uniform(0, 6))
        radius = np.maximum(radius, 0.15)
    elif kind < 0.55:  # ellipse
        angles = np.linspace(0, 2 * np.pi, 120, endpoint=False)
        radius = np.ones_like(angles)
    elif kind < 0.85:  # polygon
        angles = np.sort(rng.uniform(0, 2 * np.pi, int(rng.integers(3, 9))))
        radius = rng.uniform(0.5, 1.2, len(angles))
    else:  # rectangle
        half = np.arctan(rng.uniform(0.15, 1))
        angles = np.array([half, np.pi - half, np.pi + half, 2 * np.pi - half])
        radius, flat = np.ones(4), 1.0
    local = np.column_stack([np.cos(angles) * radius, np.sin(angles) * radius * flat]) * size / 2
    turn = rng.uniform(0, 2 * np.pi)
    cosine, sine = np.cos(turn), np.sin(turn)
    corners = centre + local @ np.array([[cosine, sine], [-sine, cosine]])
    inside = np.zeros(shape, np.uint8)
    cv2.fillPoly(inside, [np.rint(corners * 8).astype(np.int32)], 1, cv2.LINE_8, 3)
    if rng.random() < 0.25:  # limbs
        for _ in range(int(rng.integers(1, 6))):
            angle, length = rng.uniform(0, 2 * np.pi), size * rng.uniform(0.4, 1)
            end = centre + length * np.array([np.cos(angle), np.sin(angle)])
            thick = max(round(size * float(rng.uniform(0.04, 0.15))), 3)
            cv2.line(inside, tuple(np.rint(centre).astype(int)), tuple(np.rint(end).astype(int)), 1, thick)
    return inside


def _lay(canvas, segments, inside, number, surface, rng):
    """Lay a surface over the canvas: with a shadow behind, rounded shading, and an edge as sharp as its focus."""
    top, bottom, left, right = _bounds(inside, inside.shape)
    if inside[top:bottom, left:right].sum() < 30:
        return
    part = np.s_[top:bottom, left:right]
    if rng.random() < 0.35:
        offset = rng.normal(0, 12, 2)
        shifted = cv2.warpAffine(inside, np.array([[1, 0, offset[0]], [0, 1, offset[1]]]), inside.shape[::-1])
        soft = cv2.GaussianBlur(shifted.astype(np.float32), (0, 0), float(np.exp(rng.uniform(np.log(1), np.log(15)))))
        canvas *= (1 - rng.uniform(0.1, 0.6) * soft)[..., None]
    painted = surface
    if rng.random() < 0.45:
        depth = cv2.distanceTransform(inside[part], cv2.DIST_L2, 5)
        reach = max(float(depth.max()), 1.0) * rng.uniform(0.3, 1)
        dome = np.sqrt(np.clip(1 - (1 - np.clip(depth / reach, 0, 1)) ** 2, 0, 1))
        painted = painted * (1 - rng.uniform(0.1, 0.7) * (1 - dome))[..., None]
        slope_v, slope_u = np.gradient(cv2.GaussianBlur(dome, (0, 0), 3) * reach)
        angle = rng.uniform(0, 2 * np.pi)
        lit = rng.uniform(0, 0.5) * (np.cos(angle) * slope_u + np.sin(angle) * slope_v)
        painted = painted * np.exp(np.clip(lit, -0.7, 0.7))[..., None]
    cover = inside[part].astype(np.float32)
    cover = cv2.GaussianBlur(cover, (0, 0), float(np.exp(rng.uniform(np.log(0.5), np.log(5)))))
    canvas[part] += cover[..., None] * (painted - canvas[part])
    segments[part][inside[part] > 0] = number


def _shadows(shape, rng):
    """Light (H, W, 1) float32 over the finished picture: shadows that are no contours."""
    light = np.ones(shape, np.float32)
    for _ in range(int(rng.choice([0, 0, 1, 2, 3]))):
        inside = _draw_shape(shape, rng.uniform(0.1, 0.8) * max(shape), rng).astype(np.float32)
        soft = cv2.GaussianBlur(inside, (0, 0), float(np.exp(rng.uniform(np.log(2), np.log(25)))))
        light *= 1 - rng.uniform(0.1, 0.5) * soft
    return light[..., None]
