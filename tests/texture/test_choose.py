"""Exact, oracle and property: the photograph that each face is painted from."""

import numpy as np
import pytest
import trimesh
from painted_ball import ball, everywhere, look_from, make_mesh, ring

from threedfs.geometry.faces import face_areas
from threedfs.texture.choose import adjacent_faces, choose_views, measure_areas
from threedfs.texture.vertices import ABSENT, GRAZING, sample_vertices
from threedfs.types import Mesh

SEAM_COST = 0.5


def grey_samples(mesh, views, level=100):
    """Return samples of one grey level at each vertex, of the views that see it."""
    image = np.full((*views[0].camera.shape, 3), level, np.uint8)
    return sample_vertices(mesh, views, lambda name: image, everywhere, GRAZING)


def choose(mesh, views, samples, seam_cost=SEAM_COST):
    """Choose by the areas that samples tell of."""
    return choose_views(mesh, measure_areas(mesh, views, samples), seam_cost)


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
    chosen = choose(mesh, views, samples)
    sees = (samples[..., 0] < ABSENT)[:, mesh.faces].all(axis=2)
    assert not sees.all(axis=0).any() and 0.1 < (~sees.any(axis=0)).mean() < 0.5
    np.testing.assert_array_equal(chosen, np.where(sees[0], 0, np.where(sees[1], 1, -1)))


def test_without_seams_to_pay_for_each_face_gets_the_view_that_shows_it_largest():
    """Exact."""
    mesh, views = ball(3), ring(6)
    samples = grey_samples(mesh, views)
    chosen = choose(mesh, views, samples, 0.0)
    areas = measure_areas(mesh, views, samples)
    seen = chosen >= 0
    np.testing.assert_array_equal(areas[seen, chosen[seen]], areas[seen].max(axis=1))
    assert set(chosen) == {-1, *range(6)}


def test_areas_in_an_image_are_those_of_projected_triangles():
    """Oracle: a face's share of the image shrinks with its slant and the square of its distance."""
    mesh, view = ball(4), look_from(0.0)
    areas = measure_areas(mesh, [view], grey_samples(mesh, [view]))[:, 0]
    corners = mesh.vertices[mesh.faces]
    rays = view.centre - corners.mean(axis=1)
    distance = np.linalg.norm(rays, axis=1)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    ahead = (rays @ view.cam_from_world[2, :3]) / -distance  # of the optical axis
    expected = 250.0**2 * (normals * rays).sum(axis=1) / 2 / distance**3 / ahead**3
    shown = areas > 0
    assert 0.2 < shown.mean() < 0.5
    np.testing.assert_allclose(areas[shown], expected[shown], rtol=0.05)


def test_a_high_cost_of_seams_makes_fewer_of_them():
    """Property: what no view sees is the same."""
    mesh, views = ball(4), ring(12)
    samples = grey_samples(mesh, views)
    free, cheap, dear = (choose(mesh, views, samples, cost) for cost in (0.0, 0.5, 5.0))
    assert seams(mesh, dear) < seams(mesh, cheap) < seams(mesh, free)
    np.testing.assert_array_equal(dear < 0, free < 0)


def test_a_face_without_area_is_chosen_for_like_any_other():
    """Regression: its costs were no numbers, and a view that does not see it could get it."""
    mesh, views = ball(3), [look_from(0, 0), look_from(np.pi, 0)]
    samples = grey_samples(mesh, views)
    unseen = int(np.flatnonzero((samples[..., 0] == ABSENT).all(axis=0))[0])
    point = Mesh(mesh.vertices, np.concatenate([mesh.faces, [[unseen] * 3]]))
    with np.errstate(all="raise"):
        chosen = choose(point, views, samples)
    assert chosen[-1] == -1
    np.testing.assert_array_equal(chosen[:-1], choose(mesh, views, samples))


def test_a_face_is_not_painted_by_a_view_that_sees_its_back():
    """Property: even where samples claim that it does."""
    mesh, views = ball(3), [look_from(0, 0), look_from(np.pi, 0)]
    samples = np.full((2, len(mesh.vertices), 3), 100, np.uint16)
    chosen = choose(mesh, views, samples)
    x = mesh.vertices[mesh.faces].mean(axis=1)[:, 0]
    assert (chosen[x > 0.2] == 0).all() and (chosen[x < -0.2] == 1).all()
    assert (chosen[np.abs(x) < 0.02] == -1).any()
