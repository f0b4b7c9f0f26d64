"""A scrambled cube of 3x3x3 cubies, 57 mm wide, its top layer half turned."""

from __future__ import annotations

import numpy as np

from threedfs.synthetic.fields import Field, box, cylinder
from threedfs.synthetic.noise import fractal_noise
from threedfs.synthetic.objects.placing import about_z, placed
from threedfs.synthetic.solid import Material, Part, Solid, Texture, build_solid
from threedfs.synthetic.textures import mix, plain

PITCH = 0.019
_CUBIE = 0.0091
# From the cube's middle to its faces.
_HALF = PITCH + _CUBIE
# Linear RGB of the stickers: white, yellow, red, orange, blue, green.
_COLOURS = np.array(
    [
        (0.72, 0.72, 0.70),
        (0.80, 0.62, 0.03),
        (0.50, 0.02, 0.03),
        (0.78, 0.22, 0.02),
        (0.02, 0.08, 0.40),
        (0.02, 0.30, 0.07),
    ]
)
_PLASTIC = (0.018, 0.018, 0.020)


def make_rubik_cube(spacing: float = 0.0006, seed: int = 41) -> Solid:
    """Make the cube: it stands on z = 0 around the origin.

    Parameters
    ----------
    spacing : float
        Edge of a marching cubes cell.
    seed : int
        Of the scramble and of the wear.
    """
    surface = Material(_stickers(scramble(seed), seed), 0.35, 70, 0.04)
    parts = [
        Part(cylinder((0, 0, 0.002), (0, 0, 2 * _HALF - 0.002), 0.0262, 0.001), Material(plain(_PLASTIC), 0.1, 30))
    ]
    middle = (0.0, 0.0, _HALF)
    for layer, turn in ((-1, 9.0), (0, 9.0), (1, 37.0)):
        parts.append(placed(_layer(layer), surface, middle, about_z(turn)))
    # The turned layer's corners leave the square of the others.
    return build_solid(parts, (-0.042, -0.042, 0.0), (0.042, 0.042, 0.058), spacing)


def scramble(seed: int, moves: int = 30) -> np.ndarray:
    """Return the colours (6, 3, 3) int64, 0 to 5, of the faces -x, +x, -y, +y, -z, +z after random turns.

    The last two axes of a face are the two other coordinates of its cubies, in order.
    """
    rng = np.random.default_rng(seed)
    cells = np.stack(np.meshgrid(*(np.arange(-1, 2),) * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    faces = [(axis, sign) for axis in range(3) for sign in (-1, 1)]
    place = np.array([c for axis, sign in faces for c in cells[cells[:, axis] == sign]])
    normal = np.array([np.eye(3, dtype=int)[axis] * sign for axis, sign in faces for _ in range(9)])
    colour = np.repeat(np.arange(6), 9)
    for _ in range(moves):
        axis, layer, turns = rng.integers(3), rng.integers(-1, 2), rng.integers(1, 4)
        a, b = (axis + 1) % 3, (axis + 2) % 3
        moved = place[:, axis] == layer
        for vectors in (place, normal):
            for _ in range(turns):
                vectors[np.ix_(moved, [a, b])] = vectors[np.ix_(moved, [b, a])] * (-1, 1)
    out = np.empty((6, 3, 3), int)
    for where, facing, ink in zip(place, normal, colour, strict=True):
        axis = int(np.abs(facing).argmax())
        i, j = (where[k] + 1 for k in range(3) if k != axis)
        out[2 * axis + (facing[axis] > 0), i, j] = ink
    return out


def _layer(level: int) -> Field:
    """Nine rounded cubies of one layer; all layers turn about z."""

    def field(points: np.ndarray) -> np.ndarray:
        # All cubies are alike: the nearest one decides.
        local = points - PITCH * np.clip(np.rint(points / PITCH), (-1, -1, level), (1, 1, level))
        return cubie(local)

    cubie = box((0, 0, 0), (_CUBIE,) * 3, 0.0016)
    return field


def _stickers(colours: np.ndarray, seed: int) -> Texture:
    """Stickers on black plastic, in coordinates around the cube's middle."""

    def texture(points: np.ndarray, footprint: np.ndarray) -> np.ndarray:
        axis = np.abs(points).argmax(axis=1)
        rows = np.arange(len(points))
        side = 2 * axis + (points[rows, axis] > 0)
        others = np.array([[1, 2], [0, 2], [0, 1]])[axis]
        flat = points[rows[:, None], others]
        cell = np.clip(np.rint(flat / PITCH), -1, 1)
        # A sticker is a rounded square of 15.4 mm on the outer surface only.
        q = np.maximum(np.abs(flat - cell * PITCH) - 0.0057, 0)
        inside = 0.0020 - np.hypot(q[:, 0], q[:, 1])
        inside = np.minimum(inside, np.abs(points[rows, axis]) - (_HALF - 0.0009))
        i, j = (cell + 1).astype(int).T
        wear = 1 + 0.10 * fractal_noise(points, footprint, 0.012, 5, 0.7, seed + 5)
        sticker = _COLOURS[colours[side, i, j]] * wear[:, None]
        share = np.clip(inside / np.maximum(footprint, 0.0001) + 0.5, 0, 1)
        return np.clip(mix(_PLASTIC, sticker, share), 0, 1)

    return texture
