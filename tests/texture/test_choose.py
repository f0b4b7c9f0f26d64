"""Exact, oracle and property: the photograph that each face is painted from."""

import numpy as np
import pytest
import trimesh
from painted_ball import ball, everywhere, look_from, make_mesh, ring

from threedfs.geometry.faces import face_areas
from threedfs.texture.choose import ChoiceRule, adjacent_faces, choose_views, rate_views
from threedfs.texture.vertices import ABSENT, GRAZING, sample_vertices
from threedfs.types import Mesh

RULE = ChoiceRule(color_scale=15.0, seam_cost=0.5)


def grey_samples(mesh, views, level=100):
    """Return samples of one grey level at each vertex, of the views that see it."""
    image = np.full((*views[0].camera.shape, 3), level, np.uint8)
    return sample_vertices(mesh, views, lambda name: image, everywhere, GRAZING)


def seams(mesh, chosen):
    """Count the edges between two photographs."""
    pairs, _ = adjacent_faces(mesh)
    return (chosen[pairs[:, 0]] != chosen[pairs[:, 1]]).sum()


@pytest.mark.parametrize("hole", [0, 5])
def test_adjacent_faces_are_those_that_trimesh_finds(hole):
    """Oracle: on a closed and on an open mesh; the lengths are those of the edges that they share."""
    mesh = Mesh(ball(2).vertices, ball(2).faces[hole:])
    other = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    pairs, lengths = adjacent_faces(mesh)
    expected = {
        tuple(sorted(pair)): np.linalg.norm(np.diff(mesh.vertices[edge], axis=0))
        for pair, edge in zip(other.face_adjacency.tolist(), other.face_adjacency_edges, strict=True)
    }
    found = {tuple(sorted(pair)): length for pair, length in zip(pairs.tolist(), lengths, strict=True)}
    assert len(found) == len(pairs) and found == pytest.approx(expected)


def test_areas_are_those_of_trimesh():
    """Oracle."""
    torus = trimesh.creation.torus(1.0, 0.3)
    np.testing.assert_allclose(face_areas(make_mesh(torus)), torus.area_faces)


def test_a_face_that_one_view_sees_gets_it_and_one_that_none_sees_gets_none():
    """Exact: two cameras on opposite sides; a third of the ball is in neither."""
    mesh, views = ball(3), [look_from(0, 0), look_from(np.pi, 0)]
    samples = grey_samples(mesh, views)
    chosen = choose_views(mesh, views, samples, RULE)
    sees = (samples[..., 0] < ABSENT)[:, mesh.faces].all(axis=2)
    assert not sees.all(axis=0).any() and 0.1 < (~sees.any(axis=0)).mean() < 0.5
    np.testing.assert_array_equal(chosen, np.where(sees[0], 0, np.where(sees[1], 1, -1)))


def test_without_seams_to_pay_for_each_face_gets_the_view_that_shows_it_largest():
    """Exact: all views show one colour, so that the area alone decides."""
    mesh, views = ball(3), ring(6)
    samples = grey_samples(mesh, views)
    chosen = choose_views(mesh, views, samples, ChoiceRule(15.0, 0.0))
    cost = rate_views(mesh, views, samples, 15.0)
    seen = chosen >= 0
    np.testing.assert_array_equal(cost[seen, chosen[seen]], cost[seen].min(axis=1))
    assert cost[seen].min(axis=1).max() == 0 and set(chosen) == {-1, *range(6)}


def test_a_highlight_in_the_view_that_shows_a_face_largest_is_avoided():
    """Exact: where the middle one of three cameras shines, another one paints; elsewhere it still does."""
    mesh, views = ball(4), [look_from(angle) for angle in (-0.5, 0.0, 0.5)]
    samples = grey_samples(mesh, views)
    ahead = mesh.vertices[mesh.faces].mean(axis=1) @ views[1].centre / np.linalg.norm(views[1].centre)
    spot = ahead > 0.49
    assert (choose_views(mesh, views, samples, RULE)[spot] == 1).all()
    samples[1, np.unique(mesh.faces[spot])] = 255
    shining = choose_views(mesh, views, samples, RULE)
    assert set(shining[spot]) <= {0, 2}
    assert (shining[(ahead > 0.42) & (ahead < 0.46)] == 1).any()


def test_a_high_cost_of_seams_makes_fewer_of_them():
    """Property: with noise on all samples; what no view sees is the same."""
    mesh, views = ball(4), ring(12)
    samples = grey_samples(mesh, views)
    noise = np.random.default_rng(0).integers(0, 30, samples.shape, np.uint16)
    samples = np.where(samples < ABSENT, samples + noise, samples)
    free, cheap, dear = (choose_views(mesh, views, samples, ChoiceRule(15.0, cost)) for cost in (0.0, 0.5, 5.0))
    assert seams(mesh, dear) < seams(mesh, cheap) < 0.5 * seams(mesh, free)
    np.testing.assert_array_equal(dear < 0, free < 0)


def test_a_face_without_area_is_chosen_for_like_any_other():
    """Regression: its costs were no numbers, and a view that does not see it could get it."""
    mesh, views = ball(3), [look_from(0, 0), look_from(np.pi, 0)]
    samples = grey_samples(mesh, views)
    unseen = int(np.flatnonzero((samples[..., 0] == ABSENT).all(axis=0))[0])
    point = Mesh(mesh.vertices, np.concatenate([mesh.faces, [[unseen] * 3]]))
    with np.errstate(all="raise"):
        chosen = choose_views(point, views, samples, RULE)
    assert chosen[-1] == -1
    np.testing.assert_array_equal(chosen[:-1], choose_views(mesh, views, samples, RULE))


def test_a_face_is_not_painted_by_a_view_that_sees_its_back():
    """Property: even where samples claim that it does."""
    mesh, views = ball(3), [look_from(0, 0), look_from(np.pi, 0)]
    samples = np.full((2, len(mesh.vertices), 3), 100, np.uint16)
    chosen = choose_views(mesh, views, samples, RULE)
    x = mesh.vertices[mesh.faces].mean(axis=1)[:, 0]
    assert (chosen[x > 0.2] == 0).all() and (chosen[x < -0.2] == 1).all()
    assert (chosen[np.abs(x) < 0.02] == -1).any()
