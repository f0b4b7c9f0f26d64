"""Exact, property and rejection: fewer faces, as near as was asked."""

import numpy as np
import pytest
import trimesh
from painted_ball import RADIUS, ball, make_mesh

from threedfs.evaluate.surface import sample_surface
from threedfs.texture.simplify import simplify_mesh
from threedfs.types import Mesh


def joined(mesh):
    return trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)


@pytest.mark.parametrize(("tolerance", "share"), [(0.001, 0.4), (0.01, 0.03)])
def test_a_fine_ball_becomes_far_fewer_faces_within_the_tolerance(tolerance, share):
    """Property: closed, oriented as before, and nowhere deeper in the ball than the tolerance under the fine faces."""
    fine = ball(5)
    flatness = RADIUS - np.linalg.norm(fine.vertices[fine.faces].mean(axis=1), axis=1).min()
    simple = simplify_mesh(fine, tolerance)
    made = joined(simple)
    assert len(simple.faces) < share * len(fine.faces)
    assert made.is_watertight and made.is_winding_consistent and made.volume > 0
    points, _ = sample_surface(simple, 20_000, np.random.default_rng(0))
    deep = RADIUS - np.linalg.norm(np.concatenate([points, simple.vertices]), axis=1)
    assert deep.min() > -1e-9
    most = tolerance * np.linalg.norm(np.ptp(fine.vertices, axis=0))
    assert 0.5 * most < deep.max() < most + flatness


def test_more_tolerance_leaves_fewer_faces():
    counts = [len(simplify_mesh(ball(5), tolerance).faces) for tolerance in (0.001, 0.003, 0.01, 0.03)]
    assert counts == sorted(counts, reverse=True) and len(set(counts)) == 4


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e4])
def test_the_tolerance_goes_with_the_size(size):
    """Property: a ball of any size, anywhere, keeps the same faces."""
    fine = ball(4)
    moved = Mesh(size * (fine.vertices + np.array([3.0, -2.0, 1.0])), fine.faces)
    found, plain = simplify_mesh(moved, 0.005), simplify_mesh(fine, 0.005)
    assert abs(len(found.faces) - len(plain.faces)) < 0.05 * len(plain.faces)
    assert joined(found).volume == pytest.approx(size**3 * joined(plain).volume, rel=0.01)


def test_flat_faces_lose_all_but_their_corners():
    """Exact: a box in 768 faces becomes its 12, its corners where they were."""
    fine = trimesh.creation.box((1.0, 0.8, 1.4)).subdivide().subdivide().subdivide()
    simple = simplify_mesh(make_mesh(fine), 0.001)
    assert len(fine.faces) == 768 and len(simple.faces) == 12
    corners = np.array(np.meshgrid([-0.5, 0.5], [-0.4, 0.4], [-0.7, 0.7], indexing="ij")).reshape(3, -1).T
    np.testing.assert_allclose(simple.vertices[np.lexsort(simple.vertices.T[::-1])], corners, atol=1e-12)


def test_a_hole_stays():
    """Exact: a torus has one handle before and after."""
    torus = trimesh.creation.torus(1.0, 0.3, major_sections=96, minor_sections=48)
    made = joined(simplify_mesh(make_mesh(torus), 0.005))
    assert len(made.faces) < 0.3 * len(torus.faces)
    assert made.is_watertight and made.euler_number == 0


def test_sheets_that_meet_in_an_edge_are_parted():
    """Exact: two boxes that touch along an edge stay closed for those who know vertices by their place."""
    boxes = [
        trimesh.creation.box((1, 1, 1), trimesh.transformations.translation_matrix(t)) for t in ((0, 0, 0), (1, 1, 0))
    ]
    simple = simplify_mesh(make_mesh(trimesh.util.concatenate(boxes)), 1e-4)
    by_place = trimesh.Trimesh(simple.vertices.astype(np.float32), simple.faces, process=False)
    by_place.merge_vertices(digits_vertex=6)
    assert len(simple.faces) == 24 and len(by_place.vertices) == 16
    assert by_place.is_watertight
    assert joined(simple).volume == pytest.approx(2, abs=1e-3)


def test_shreds_are_dropped_and_cavities_stay():
    """Exact: of two balls, one of which is a thousandth as large, one is left; a hollow is a part, too."""
    whole, hollow = trimesh.creation.icosphere(4), trimesh.creation.icosphere(4, 0.3)
    shred = trimesh.creation.icosphere(2, 0.001).apply_translation([2, 0, 0])
    hollow.invert()
    made = joined(simplify_mesh(make_mesh(trimesh.util.concatenate([whole, hollow, shred])), 1e-5))
    assert made.body_count == 2 and made.is_watertight
    assert made.volume == pytest.approx(whole.volume + hollow.volume, rel=1e-3)


def test_a_mesh_that_is_not_closed_gives_none():
    """Rejection: one face is left out."""
    closed = ball(3)
    assert simplify_mesh(closed, 0.001) is not None
    assert simplify_mesh(Mesh(closed.vertices, closed.faces[1:]), 0.001) is None


def test_the_same_faces_twice():
    first, second = (simplify_mesh(ball(4), 0.003) for _ in range(2))
    np.testing.assert_array_equal(first.vertices, second.vertices)
    np.testing.assert_array_equal(first.faces, second.faces)
