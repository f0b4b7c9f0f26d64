"""The object of a scene: parts with their materials, and one closed mesh around all of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import trimesh
from scipy.ndimage import label
from skimage.measure import marching_cubes

from threedfs.errors import UserError
from threedfs.synthetic.fields import Field, half_space, intersection, union
from threedfs.types import Mesh

# Cells along the edge of a block that is sampled as a whole, and the steepest slope that fields may have.
_BLOCK = 4
_STEEPEST = 2.0

# Colour of points (N, 3) with pixel footprints (N,): linear RGB (N, 3) in [0, 1].
Texture = Callable[[np.ndarray, np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Material:
    """How a surface answers light.

    Attributes
    ----------
    texture : Texture
        Diffuse colour.
    specular : float
        Strength of the Blinn-Phong highlight, 0 (matt) to about 1.
    shininess : float
        Its exponent: 10 broad, 200 sharp.
    mirror : float
        Share of the surroundings reflected at normal incidence, 0 to 1; more at grazing angles.
    """

    texture: Texture
    specular: float = 0.0
    shininess: float = 40.0
    mirror: float = 0.0


@dataclass(frozen=True)
class Part:
    """A shape and what it is made of."""

    field: Field
    material: Material


@dataclass(frozen=True)
class Solid:
    """An object ready to be rendered.

    Attributes
    ----------
    mesh : Mesh
        Closed, one component, standing on the plane z = 0.
    normals : (V, 3) float64
        Unit outward normals at the vertices.
    materials : tuple of Material
    material_of : callable
        Maps surface points (N, 3) to indices (N,) into `materials`.
    """

    mesh: Mesh
    normals: np.ndarray
    materials: tuple[Material, ...]
    material_of: Callable[[np.ndarray], np.ndarray]


def build_solid(parts: Sequence[Part], low: Sequence[float], high: Sequence[float], spacing: float) -> Solid:
    """Mesh the union of the parts above z = 0 by marching cubes.

    Parameters
    ----------
    parts : sequence of Part
        Where parts overlap, the surface has the material of the part whose field is lowest.
    low, high : (3,) float
        Box around the object.
    spacing : float
        Edge of a cell.

    Raises
    ------
    UserError
        If the parts leave the box, or do not hang together.
    """
    whole = intersection(union(*(part.field for part in parts)), half_space((0, 0, 0), (0, 0, -1)))
    low, high = np.asarray(low, float) - 2 * spacing, np.asarray(high, float) + 2 * spacing
    axes = [np.arange(a, b, spacing) for a, b in zip(low, high, strict=True)]
    values = _sample_near_surface(whole, axes, spacing)
    rim = [np.take(values, end, axis=axis).min() for axis in range(3) for end in (0, -1)]
    if min(rim) <= 0:
        raise UserError(f"The parts of an object must lie in the box {low} to {high}; enlarge the box.")
    # Hollows that nothing outside can see would be a second surface: fill them.
    empty, _ = label(values > 0)
    values = np.where((empty > 0) & (empty != empty[0, 0, 0]), -spacing, values)
    vertices, faces, _, _ = marching_cubes(values, 0.0, spacing=(spacing,) * 3, gradient_direction="descent")
    # Files hold single precision: what is rendered is then exactly what is shipped.
    vertices = (vertices + low).astype(np.float32).astype(np.float64)
    surface = trimesh.Trimesh(vertices, faces, process=True)
    # Only faces whose corners fell together: a sliver that keeps three corners holds its neighbours together.
    corners = np.sort(surface.faces, axis=1)
    surface.update_faces((corners[:, 0] != corners[:, 1]) & (corners[:, 1] != corners[:, 2]))
    surface.remove_unreferenced_vertices()
    if surface.body_count != 1:
        raise UserError(f"The parts of an object must hang together, got {surface.body_count} pieces.")
    mesh = Mesh(np.asarray(surface.vertices), np.asarray(surface.faces, np.int64))

    def material_of(points: np.ndarray) -> np.ndarray:
        return np.argmin([part.field(points) for part in parts], axis=0)

    normals = _field_normals(whole, mesh.vertices, spacing / 4)
    return Solid(mesh, normals, tuple(part.material for part in parts), material_of)


def _sample_near_surface(field: Field, axes: Sequence[np.ndarray], spacing: float) -> np.ndarray:
    """Evaluate a field on a grid: exactly on all edges that its surface crosses, elsewhere with the right sign.

    A block of cells is left at the value of its middle where the surface is too far to reach it.
    """
    shape = tuple(len(axis) for axis in axes)
    nodes = np.stack(np.meshgrid(*(np.arange(_BLOCK),) * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    blocks = np.stack(np.meshgrid(*(np.arange(0, n, _BLOCK) for n in shape), indexing="ij"), axis=-1).reshape(-1, 3)
    start = np.array([axis[0] for axis in axes])
    middle = _in_chunks(field, start + (blocks + (_BLOCK - 1) / 2) * spacing)
    values = middle.reshape([-(-n // _BLOCK) for n in shape])
    for axis, n in enumerate(shape):
        values = np.repeat(values, _BLOCK, axis=axis).take(range(n), axis=axis)
    # From the middle to the farthest node, and one edge more.
    reach = np.sqrt(3) * (_BLOCK + 1) / 2 * spacing
    near = blocks[np.abs(middle) < _STEEPEST * reach]
    index = (near[:, None] + nodes).reshape(-1, 3)
    i, j, k = index[np.all(index < shape, axis=1)].T
    points = np.column_stack([axes[0][i], axes[1][j], axes[2][k]])
    values[i, j, k] = _in_chunks(field, points)
    return values


def _in_chunks(field: Field, points: np.ndarray) -> np.ndarray:
    """Evaluate a field on pieces that fit into the processor's cache."""
    pieces = np.array_split(points, len(points) // 20000 + 1)
    return np.concatenate([field(piece) for piece in pieces])


def _field_normals(field: Field, points: np.ndarray, step: float) -> np.ndarray:
    """Outward unit normals by central differences."""
    steps = step * np.eye(3)
    gradient = np.stack([field(points + s) - field(points - s) for s in steps], axis=-1)
    return gradient / np.maximum(np.linalg.norm(gradient, axis=-1, keepdims=True), 1e-12)
