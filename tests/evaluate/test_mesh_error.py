"""Exact, property and oracle (trimesh, SciPy, all pairs): distances between surfaces whose distance is known."""

import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from threedfs.evaluate.mesh_error import (
    bounding_diagonal,
    count_pieces,
    filled_share,
    find_genus,
    is_closed,
    measure_mesh,
)
from threedfs.evaluate.surface import SurfaceDistance, sample_surface, triangle_distance
from threedfs.types import Mesh


def sphere(radius=1.0, subdivisions=4):
    made = trimesh.creation.icosphere(subdivisions=subdivisions, radius=radius)
    return Mesh(np.asarray(made.vertices), np.asarray(made.faces))


def measure(mesh, truth, thresholds=(0.5, 1.0)):
    return measure_mesh(mesh, truth, thresholds, 5000, np.random.default_rng(0))


def test_concentric_spheres():
    truth, mesh = sphere(1.0), sphere(1.02)
    diagonal = 2 * np.sqrt(3)
    gap = 0.02 / diagonal  # 0.577 % of the diagonal
    error = measure(mesh, truth)
    # the sag of the facets, 0.05 % of the radius, is 3 % of the gap
    assert error.accuracy == pytest.approx(gap, rel=0.03)
    assert error.completeness == pytest.approx(gap, rel=0.03)
    assert error.chamfer == (error.accuracy + error.completeness) / 2
    half, one = error.agreement
    assert (half.precision, half.recall, half.f_score) == (0, 0, 0)
    assert (one.precision, one.recall, one.f_score) == (1, 1, 1)


def test_against_nearest_points_of_dense_samples():
    # a bumpy surface against a sphere: trimesh draws the points, a tree finds the nearest
    truth = sphere()
    bumps = 1 + 0.03 * np.sin(5 * truth.vertices[:, :1]) + 0.02 * truth.vertices[:, 2:]
    mesh = Mesh(truth.vertices * bumps, truth.faces)
    drawn = [
        np.asarray(trimesh.sample.sample_surface(trimesh.Trimesh(one.vertices, one.faces), 200_000, seed=number)[0])
        for number, one in enumerate((mesh, truth))
    ]
    diagonal = np.linalg.norm(np.ptp(truth.vertices, axis=0))
    to_truth, to_mesh = (cKDTree(there).query(here[:20_000])[0] / diagonal for here, there in (drawn, reversed(drawn)))
    error = measure(mesh, truth)
    # 200,000 points lie 0.2 % of the diagonal apart, which adds under 2 % to distances of about 0.6 %
    assert error.accuracy == pytest.approx(to_truth.mean(), rel=0.04)
    assert error.completeness == pytest.approx(to_mesh.mean(), rel=0.04)
    for agreement in error.agreement:
        precision, recall = ((distance <= agreement.threshold / 100).mean() for distance in (to_truth, to_mesh))
        expected = 2 * precision * recall / (precision + recall)
        assert agreement.f_score == pytest.approx(expected, abs=0.03)


def test_a_surface_is_at_no_distance_from_itself():
    error = measure(sphere(), sphere())
    # the nearest facet is missed for a few samples, and the one beside it taken
    assert error.accuracy < 1e-6 and error.completeness < 1e-6
    assert error.agreement[0].f_score == 1


def test_half_a_sphere_is_precise_and_half_complete():
    truth = sphere()
    centres = truth.vertices[truth.faces].mean(1)
    mesh = Mesh(truth.vertices, truth.faces[centres[:, 2] > 0])
    error = measure(mesh, truth, (0.5,))
    assert error.agreement[0].precision == 1
    # by Archimedes the strip within 0.5 % of the diagonal below the equator adds under 1 % of the area; 5000 samples
    # put the standard deviation of the share at 0.7 %
    assert error.agreement[0].recall == pytest.approx(0.505, abs=0.025)
    precision, recall = 1.0, error.agreement[0].recall
    assert error.agreement[0].f_score == pytest.approx(2 * precision * recall / (precision + recall))


def test_shares_do_not_change_with_scale_and_motion():
    rotation = Rotation.from_rotvec([0.5, 0.2, -1]).as_matrix()

    def move(mesh):
        return Mesh(4 * mesh.vertices @ rotation.T + [1, 2, 3], mesh.faces)

    truth, mesh = sphere(1.0, 2), sphere(1.01, 2)
    # the diagonal of an axis-aligned box does turn with the mesh; compare with it taken out
    plain, moved = measure(mesh, truth), measure(move(mesh), move(truth))
    ratio = bounding_diagonal(move(truth)) / (4 * bounding_diagonal(truth))
    assert moved.accuracy * ratio == pytest.approx(plain.accuracy, rel=1e-9)


def test_same_seed_same_figures():
    assert measure(sphere(1.01), sphere()) == measure(sphere(1.01), sphere())


def test_samples_lie_on_the_mesh_and_follow_area():
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 3]])
    mesh = Mesh(corners, np.array([[0, 1, 2], [0, 1, 3]]))
    points, face = sample_surface(mesh, 20000, np.random.default_rng(1))
    assert np.abs(points[face == 0, 2]).max() == 0 and np.abs(points[face == 1, 1]).max() == 0
    assert (face == 1).mean() == pytest.approx(0.75, abs=4 * np.sqrt(0.75 * 0.25 / 20000))
    np.testing.assert_allclose(points[face == 0].mean(0), [1 / 3, 1 / 3, 0], atol=0.01)


def test_triangle_distance_against_trimesh():
    generator = np.random.default_rng(2)
    corners, points = generator.normal(size=(500, 3, 3)), 2 * generator.normal(size=(500, 3))
    corners[-1] = corners[-1, :1] + np.outer([0, 1, 3], [1.0, 2, 0])  # no area
    closest = trimesh.triangles.closest_point(corners[:-1], points[:-1])
    expected = np.linalg.norm(closest - points[:-1], axis=1)
    np.testing.assert_allclose(triangle_distance(points, corners)[:-1], expected, rtol=1e-9, atol=1e-9)
    assert np.isfinite(triangle_distance(points, corners)[-1])


def test_surface_distance_against_all_triangles():
    mesh = sphere(1.0, 2)
    generator = np.random.default_rng(3)
    points = generator.normal(size=(200, 3))
    samples, face = sample_surface(mesh, 2000, generator)
    corners = mesh.vertices[mesh.faces]
    expected = [triangle_distance(np.tile(point, (len(corners), 1)), corners).min() for point in points]
    np.testing.assert_allclose(SurfaceDistance(mesh, samples, face)(points), expected, atol=1e-12)


def test_closed_means_every_edge_twice_and_opposite():
    whole = sphere(1.0, 1)
    assert is_closed(whole)
    assert not is_closed(Mesh(whole.vertices, whole.faces[1:]))
    flipped = whole.faces.copy()
    flipped[0] = flipped[0, ::-1]
    assert not is_closed(Mesh(whole.vertices, flipped))
    assert not is_closed(Mesh(whole.vertices, np.concatenate([whole.faces, whole.faces])))


def test_pieces_share_no_vertex():
    whole = sphere(1.0, 1)
    shifted = Mesh(
        np.concatenate([whole.vertices, whole.vertices + 3]), np.concatenate([whole.faces, whole.faces + 42])
    )
    assert len(whole.vertices) == 42
    assert count_pieces(whole) == 1 and count_pieces(shifted) == 2
    assert count_pieces(Mesh(shifted.vertices, whole.faces)) == 1  # vertices of no face are no piece


def test_the_filled_share_of_a_ball_is_pi_over_six_and_turns_with_its_faces():
    ball = sphere(2.0)
    assert filled_share(ball) == pytest.approx(np.pi / 6, rel=0.01)
    assert filled_share(Mesh(ball.vertices + 7, ball.faces[:, ::-1])) == pytest.approx(-filled_share(ball))
    assert filled_share(ball) == pytest.approx(trimesh.Trimesh(ball.vertices, ball.faces).volume / 64, rel=1e-2)


def test_far_share_and_normals():
    """Exact: one of two equal balls lies far away; a tilted plate's normals are off by its tilt."""
    truth = sphere()
    aside = sphere().vertices + np.array([6.0, 0.0, 0.0])
    both = Mesh(np.concatenate([truth.vertices, aside]), np.concatenate([truth.faces, truth.faces + len(aside)]))
    error = measure(both, truth)
    assert error.far_share == pytest.approx(0.5, abs=0.02)
    assert measure(truth, truth).normal_error < 0.5 and measure(truth, truth).far_share == 0
    plate = trimesh.creation.box((1.0, 1.0, 0.001))
    turn = Rotation.from_euler("x", 7, degrees=True).as_matrix()
    tilted = Mesh(np.asarray(plate.vertices) @ turn.T, np.asarray(plate.faces))
    flat = Mesh(np.asarray(plate.vertices), np.asarray(plate.faces))
    assert measure(tilted, flat).normal_error == pytest.approx(7, abs=0.01)


@pytest.mark.parametrize(
    "made, genus",
    [
        (trimesh.creation.icosphere(subdivisions=2), 0),
        (trimesh.creation.torus(1.0, 0.3), 1),
        (trimesh.util.concatenate([trimesh.creation.torus(1.0, 0.3), trimesh.creation.box()]), 1),
    ],
    ids=["sphere", "torus", "torus and box"],
)
def test_genus(made, genus):
    """Exact; vertices that are stored once for each face count once."""
    mesh = Mesh(np.asarray(made.vertices), np.asarray(made.faces))
    apart = Mesh(mesh.vertices[mesh.faces].reshape(-1, 3), np.arange(3 * len(mesh.faces)).reshape(-1, 3))
    assert find_genus(mesh) == find_genus(apart) == genus
