"""Noise that never repeats: functions of position from a hashed lattice, so that textures need no images."""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True)
def _hash(x: int, y: int, z: int, seed: int) -> float:
    """Map an integer lattice point to a number in [0, 1) that looks random."""
    h = np.uint32(x * 374761393 + y * 668265263 + z * 1274126177 + seed * 974711)
    h = np.uint32((h ^ (h >> np.uint32(15))) * np.uint32(2246822519))
    h = np.uint32((h ^ (h >> np.uint32(13))) * np.uint32(3266489917))
    h = np.uint32(h ^ (h >> np.uint32(16)))
    return h / 4294967296.0


@njit(cache=True)
def _value_noise(x: float, y: float, z: float, seed: int) -> float:
    """Interpolate the hashed lattice with quintic weights; in [0, 1)."""
    i, j, k = np.floor(x), np.floor(y), np.floor(z)
    a, b, c = x - i, y - j, z - k
    a = a * a * a * (a * (a * 6 - 15) + 10)
    b = b * b * b * (b * (b * 6 - 15) + 10)
    c = c * c * c * (c * (c * 6 - 15) + 10)
    p, q, r = int(i), int(j), int(k)
    total = 0.0
    for dz in range(2):
        wz = c if dz else 1 - c
        for dy in range(2):
            wy = b if dy else 1 - b
            if wz * wy == 0:
                continue  # as half of the lattice points are to a point of the table's top
            low = _hash(p, q + dy, r + dz, seed)
            high = _hash(p + 1, q + dy, r + dz, seed)
            total += wz * wy * (low + a * (high - low))
    return total


@njit(cache=True)
def _fractal(
    points: np.ndarray, footprint: np.ndarray, wavelength: float, octaves: int, gain: float, seed: int
) -> np.ndarray:
    out = np.empty(len(points))
    for n in range(len(points)):
        step, weight, total, norm = wavelength, 1.0, 0.0, 0.0
        for octave in range(octaves):
            # An octave finer than the pixel would only flicker: fade it out to its mean.
            visible = min(max(step / max(footprint[n], 1e-12) - 1.0, 0.0), 1.0)
            if visible > 0:
                value = _value_noise(points[n, 0] / step, points[n, 1] / step, points[n, 2] / step, seed + octave)
                total += weight * visible * (2 * value - 1)
            norm += weight
            weight *= gain
            step *= 0.5
        out[n] = total / norm
    return out


def fractal_noise(
    points: np.ndarray,
    footprint: np.ndarray | float,
    wavelength: float,
    octaves: int = 5,
    gain: float = 0.6,
    seed: int = 0,
) -> np.ndarray:
    """Sum octaves of value noise at points (N, 3).

    Parameters
    ----------
    points : (N, 3) float64
        Positions in the unit of `wavelength`; scale their axes first for stretched noise.
    footprint : (N,) float64 or float
        Size of a pixel at each point, same unit; octaves finer than twice that fade out. 0 keeps all.
    wavelength : float
        Lattice spacing of the coarsest octave.
    octaves : int
        How many times the spacing is halved, plus one.
    gain : float
        Amplitude of an octave over that of the coarser one.
    seed : int
        Another seed, another texture.

    Returns
    -------
    (N,) float64
        In [-1, 1], mean about 0.
    """
    points = np.ascontiguousarray(points, np.float64)
    footprint = np.ascontiguousarray(np.broadcast_to(np.asarray(footprint, np.float64), len(points)))
    return _fractal(points, footprint, float(wavelength), octaves, float(gain), seed)


@njit(cache=True)
def _hash_cells(cells: np.ndarray, seed: int) -> np.ndarray:
    out = np.empty(len(cells))
    for n in range(len(cells)):
        out[n] = _hash(cells[n, 0], cells[n, 1], cells[n, 2], seed)
    return out


def hash_cells(*indices: np.ndarray, seed: int = 0) -> np.ndarray:
    """Give every cell of an integer lattice its own number in [0, 1).

    Parameters
    ----------
    *indices : (N,) integers or floats without fraction
        One to three cell coordinates.
    seed : int
        Another seed, other numbers.
    """
    cells = np.zeros((len(indices[0]), 3), np.int64)
    for axis, index in enumerate(indices):
        cells[:, axis] = index
    return _hash_cells(cells, seed)


@njit(cache=True)
def _cells(points: np.ndarray, seed: int) -> np.ndarray:
    out = np.empty((3, len(points)))
    for n in range(len(points)):
        i, j, k = int(np.floor(points[n, 0])), int(np.floor(points[n, 1])), int(np.floor(points[n, 2]))
        first, second, name = np.inf, np.inf, 0.0
        for x in range(i - 1, i + 2):
            for y in range(j - 1, j + 2):
                for z in range(k - 1, k + 2):
                    # Seeds stay off the faces of their cell: hardly ever is one beyond these 27 among the nearest two.
                    dx = x + 0.05 + 0.9 * _hash(x, y, z, seed) - points[n, 0]
                    dy = y + 0.05 + 0.9 * _hash(x, y, z, seed + 1) - points[n, 1]
                    dz = z + 0.05 + 0.9 * _hash(x, y, z, seed + 2) - points[n, 2]
                    distance = np.sqrt(dx * dx + dy * dy + dz * dz)
                    if distance < first:
                        first, second, name = distance, first, _hash(x, y, z, seed + 3)
                    elif distance < second:
                        second = distance
        out[0, n], out[1, n], out[2, n] = first, second, name
    return out


def cell_noise(points: np.ndarray, size: float, seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Divide space into irregular cells about `size` wide (Worley 1996).

    Returns
    -------
    first, second : (N,) float64
        Distances from points (N, 3) to the nearest two seeds of cells, in units of `size`; equal between two cells.
    name : (N,) float64
        The cell's own number in [0, 1).
    """
    first, second, name = _cells(np.ascontiguousarray(points, np.float64) / size, seed)
    return first, second, name
