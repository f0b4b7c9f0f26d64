"""Levels of detail: a closed mesh with as many faces as are asked for."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from threedfs.evaluate.mesh_error import is_closed
from threedfs.evaluate.surface import SurfaceDistance, sample_surface
from threedfs.texture.simplify import simplify_mesh
from threedfs.types import Mesh

_FIRST, _LAST = 1e-4, 0.1
"""Tolerances that are tried, lengths of the diagonal of the mesh's box."""
_STEP = 1.4
_HALVINGS = 4
_SAMPLES = 50_000


@dataclass(frozen=True)
class Level:
    """A mesh of fewer faces.

    Attributes
    ----------
    mesh : Mesh
        Closed.
    mean_error, largest_error : float
        Distance from the vertices of the full mesh to it, in the unit of the mesh.
    """

    mesh: Mesh
    mean_error: float
    largest_error: float


def make_levels(
    mesh: Mesh, faces: Sequence[int], finish: Callable[[Mesh], Mesh] = lambda mesh: mesh, seed: int = 0
) -> dict[int, Level] | None:
    """Return for each number of faces a mesh that has no more, or as few as can be; None if the mesh is not closed.

    Faces are merged in small steps of growing tolerance: one large step leaves more of them than many small ones do.

    Parameters
    ----------
    mesh : Mesh
    faces : sequence of int
        Some hundreds at least: with fewer little of the shape is left.
    finish : callable
        What is done to a mesh that lost faces before its distance is measured.
    seed : int
        Of the samples that distances are found with.
    """
    if not is_closed(mesh):
        return None
    levels: dict[int, Level] = {}
    before, known, tolerance = mesh, mesh, _FIRST / _STEP
    for count in sorted(faces, reverse=True):
        while len(known.faces) > count and tolerance < _LAST:
            before, tolerance = known, tolerance * _STEP
            known = simplify_mesh(before, tolerance) or before
        level = known if known is before else _come_close(before, known, count, tolerance)
        levels[count] = _measure(mesh, level if level is mesh else finish(level), seed)
    return levels


def _come_close(more: Mesh, fewer: Mesh, count: int, tolerance: float) -> Mesh:
    """Return a mesh between two that has as close to `count` faces as can be, and no more."""
    low, high = tolerance / _STEP, tolerance
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        tried = simplify_mesh(more, middle)
        if tried is None or len(tried.faces) > count:
            low = middle
        else:
            high, fewer = middle, tried if len(tried.faces) > len(fewer.faces) else fewer
    return fewer


def _measure(full: Mesh, fewer: Mesh, seed: int) -> Level:
    samples, face = sample_surface(fewer, _SAMPLES, np.random.default_rng(seed))
    apart = SurfaceDistance(fewer, samples, face)(full.vertices)
    return Level(fewer, float(apart.mean()), float(apart.max()))
