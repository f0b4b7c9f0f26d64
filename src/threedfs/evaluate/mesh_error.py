"""Error of a mesh against the true one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from threedfs.evaluate.surface import SurfaceDistance, face_vectors, sample_surface
from threedfs.object.extract import enclosed_volume, find_shells
from threedfs.types import Mesh

_FAR = 0.02
"""Share of the diagonal beyond which a surface is no longer rough but elsewhere."""


@dataclass(frozen=True)
class Agreement:
    """How much of two surfaces lies within a threshold of the other.

    Attributes
    ----------
    threshold : float
        In % of the diagonal.
    precision : float
        Share of the mesh's area that lies within the threshold of the true surface.
    recall : float
        Share of the true area that lies within the threshold of the mesh.
    """

    threshold: float
    precision: float
    recall: float

    @property
    def f_score(self) -> float:
        """Harmonic mean of precision and recall."""
        total = self.precision + self.recall
        return 2 * self.precision * self.recall / total if total > 0 else 0.0


@dataclass(frozen=True)
class MeshError:
    """Distances between two surfaces as shares of the diagonal of the true one's bounding box.

    Attributes
    ----------
    accuracy : float
        Mean distance from the mesh to the truth.
    completeness : float
        Mean distance from the truth to the mesh.
    agreement : tuple of Agreement
        One for each threshold.
    far_share : float
        Share of the mesh's area that is farther than 2 % of the diagonal from the true surface.
    normal_error : float
        Median angle between the normals of the mesh and of the true surface where that is nearest, degrees.
    """

    accuracy: float
    completeness: float
    agreement: tuple[Agreement, ...]
    far_share: float
    normal_error: float

    @property
    def chamfer(self) -> float:
        """Mean of accuracy and completeness."""
        return (self.accuracy + self.completeness) / 2


def bounding_diagonal(mesh: Mesh) -> float:
    """Return the diagonal of the axis-aligned bounding box of the vertices that faces use."""
    return float(np.linalg.norm(np.ptp(mesh.vertices[np.unique(mesh.faces)], axis=0)))


def measure_mesh(
    mesh: Mesh, truth: Mesh, thresholds: Sequence[float], count: int, generator: np.random.Generator
) -> MeshError:
    """Measure a mesh against the true one, both in the coordinates of the truth.

    The whole true surface counts, the base it stands on too: what closes the base is part of the result.

    Parameters
    ----------
    mesh, truth : Mesh
    thresholds : sequence of float
        In % of the diagonal of the true mesh's bounding box.
    count : int
        Points drawn on each surface.
    generator : numpy.random.Generator

    Notes
    -----
    Precision, recall and F-score after Knapitsch et al., Tanks and Temples, 2017.
    """
    diagonal = bounding_diagonal(truth)
    mesh_points, mesh_face = sample_surface(mesh, count, generator)
    true_points, true_face = sample_surface(truth, count, generator)
    apart, opposite = SurfaceDistance(truth, true_points, true_face).find(mesh_points)
    to_truth = apart / diagonal
    to_mesh = SurfaceDistance(mesh, mesh_points, mesh_face)(true_points) / diagonal
    agreement = tuple(
        Agreement(threshold, float((to_truth <= threshold / 100).mean()), float((to_mesh <= threshold / 100).mean()))
        for threshold in thresholds
    )
    angle = _angles(face_vectors(mesh)[mesh_face], face_vectors(truth)[opposite])
    return MeshError(
        float(to_truth.mean()),
        float(to_mesh.mean()),
        agreement,
        float((to_truth > _FAR).mean()),
        float(np.median(angle)),
    )


def _angles(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return the angle (N,) between vectors (N, 3) of any length, degrees; exact for small ones, too."""
    return np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), (a * b).sum(axis=1)))


def is_closed(mesh: Mesh) -> bool:
    """Say whether every edge is shared by exactly two faces that run along it in opposite directions.

    Examples
    --------
    >>> corners = np.array([[0., 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> is_closed(Mesh(corners, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])))
    True
    >>> is_closed(Mesh(corners, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3]])))
    False
    """
    edges = np.concatenate([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]], mesh.faces[:, [2, 0]]]).astype(np.int64)
    count = len(mesh.vertices)
    forward = np.sort(edges[:, 0] * count + edges[:, 1])
    backward = np.sort(edges[:, 1] * count + edges[:, 0])
    unique = bool(np.all(np.diff(forward) > 0))
    return len(edges) > 0 and unique and bool(np.array_equal(forward, backward))


def count_pieces(mesh: Mesh) -> int:
    """Return the number of pieces that share no vertex."""
    return len(np.unique(find_shells(mesh)[mesh.faces[:, 0]]))


def find_genus(mesh: Mesh) -> int:
    """Return the number of handles of a closed mesh, over all of its pieces; vertices at one place count as one.

    Pieces that touch at a vertex count as one piece, too, so that the number is a little low then.

    Examples
    --------
    >>> corners = np.array([[0., 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> find_genus(Mesh(corners, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])))
    0
    """
    places, welded = np.unique(mesh.vertices, axis=0, return_inverse=True)
    faces = welded.reshape(-1)[mesh.faces]
    faces = faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]
    joined = Mesh(places, faces)
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    characteristic = len(np.unique(faces)) - len(np.unique(edges, axis=0)) + len(faces)
    return max(0, round(count_pieces(joined) - characteristic / 2))


def filled_share(mesh: Mesh) -> float:
    """Return the volume of a closed mesh as a share of its bounding box; negative if its faces look inwards.

    Examples
    --------
    >>> filled_share(Mesh(np.array([[0., 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]])))  # a flat one
    0.0
    """
    box = float(np.prod(np.ptp(mesh.vertices[np.unique(mesh.faces)], axis=0)))
    return enclosed_volume(mesh) / box if box else 0.0
