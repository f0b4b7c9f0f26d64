"""Colours of a mesh's vertices, from the photographs that see them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from threedfs.geometry.faces import join_vertices
from threedfs.geometry.visible import see_vertices
from threedfs.types import Mesh, View

SQUARE, GRAZING = 0.3, 0.1
"""Cosines between a vertex's normal and the ray to a camera: from the first, the camera shows the vertex rather than
the edge there; from the second, it sees it at all."""
_AGREE = 16.0
"""Levels by which a photograph that confirms a vertex may differ from the median of all."""
ABSENT = 256
"""What a sample has where a view does not see the vertex."""
Reader = Callable[[str], np.ndarray]


def sample_vertices(
    mesh: Mesh, views: Sequence[View], read_image: Reader, read_valid: Reader, least_cosine: float = SQUARE
) -> np.ndarray:
    """Return the colour that each view has of each vertex: (views, V, 3) uint16, ABSENT where it does not see it.

    Parameters
    ----------
    mesh : Mesh
        World.
    views : sequence of View
    read_image, read_valid : callable
        Give the image (H, W, 3) uint8 RGB of a view by its name, and which pixels (H, W) bool show the scene.
    least_cosine : float
        Between a vertex's normal and the ray to a camera, from which the camera sees it.
    """
    samples = np.full((len(views), len(mesh.vertices), 3), ABSENT, np.uint16)
    for rank, seen in enumerate(see_vertices(mesh, views, least_cosine)):
        image, valid = read_image(seen.view.name), read_valid(seen.view.name)
        clear = valid[seen.row, seen.column]
        samples[rank, seen.vertices[clear]] = image[seen.row[clear], seen.column[clear]]
    return samples


def color_vertices(mesh: Mesh, samples: np.ndarray) -> np.ndarray:
    """Return the colour (V, 3) uint8 of each vertex: the median over the views that see it, in each channel.

    Not in the paper. A median, as a highlight or an outline a pixel aside is in few views. A vertex that no view sees
    has the mean colour of the nearest ones along the mesh that are seen; a piece of which none is seen is grey.

    Parameters
    ----------
    mesh : Mesh
    samples : (views, V, 3) uint16
        As `sample_vertices` returns them.
    """
    middle, count = median_samples(samples)
    return np.clip(np.rint(spread_colors(mesh, middle, count > 0)), 0, 255).astype(np.uint8)


def median_samples(samples: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the median sample of each vertex in each channel, (V, 3) uint16, and how many views see it, (V,)."""
    count = (samples[..., 0] < ABSENT).sum(axis=0)
    ordered = np.sort(samples, axis=0)
    last = np.maximum(count - 1, 0)
    low, high = (np.take_along_axis(ordered, rank[None, :, None], axis=0)[0] for rank in (last // 2, (last + 1) // 2))
    return (low + high + 1) // 2, count


def confirm_vertices(samples: np.ndarray) -> np.ndarray:
    """Return the share (V,) float32 of the views that see a vertex which agree on its colour; 0 where none sees it.

    Where the surface is wrong, or shines, each view sees something else at a vertex.

    Parameters
    ----------
    samples : (views, V, 3) uint16
        As `sample_vertices` returns them.
    """
    middle, count = median_samples(samples)
    apart = np.abs(samples.astype(np.float32) - middle).mean(axis=2)
    agree = ((apart <= _AGREE) & (samples[..., 0] < ABSENT)).sum(axis=0)
    return (agree / np.maximum(count, 1)).astype(np.float32)


def spread_colors(mesh: Mesh, colors: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Return colours (V, 3) float64, handed on from known vertices to their neighbours, ring by ring; else grey."""
    colors = np.where(known[:, None], colors, 0.0)
    beside = join_vertices(mesh)
    while True:
        weight = beside @ known.astype(np.float64)
        reached = ~known & (weight > 0)
        if not reached.any():
            break
        colors[reached] = (beside @ colors)[reached] / weight[reached, None]
        known = known | reached
    return np.where(known[:, None], colors, 128.0)
