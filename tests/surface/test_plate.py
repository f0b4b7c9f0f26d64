"""A bent plate: what depth holds stays, what nothing holds becomes smooth."""

import numpy as np
import pytest
import trimesh
from slab import GRID, confirm, make_slab

from threedfs.geometry.faces import vertex_normals
from threedfs.object.extract import extract_surface
from threedfs.surface.plate import bend_mesh, support_vertices
from threedfs.types import Mesh, Plane

FLOOR = Plane(np.array([0.0, 0, 1]), 0.0)


@pytest.fixture(scope="module")
def ball():
    made = trimesh.creation.icosphere(subdivisions=5, radius=0.5)
    return Mesh(np.asarray(made.vertices), np.asarray(made.faces))


def roughen(mesh, deviation=0.004):
    noise = np.random.default_rng(0).normal(0, deviation, len(mesh.vertices))
    return Mesh(mesh.vertices + noise[:, None] * vertex_normals(mesh), mesh.faces)


def roughness(mesh):
    return np.std(np.linalg.norm(mesh.vertices, axis=1))


def test_noise_comes_off_where_nothing_holds_it_and_a_ball_stays(ball):
    rough, loose = roughen(ball), np.full(len(ball.vertices), 0.03)
    assert roughness(bend_mesh(rough, loose, 10.0)) < 0.4 * roughness(rough)
    smooth = bend_mesh(ball, loose, 10.0)
    assert np.abs(np.linalg.norm(smooth.vertices, axis=1) - 0.5).max() < 0.003


def test_what_is_held_stays_and_stiffness_acts(ball):
    rough, held = roughen(ball), np.full(len(ball.vertices), 0.03)
    held[ball.vertices[:, 0] > 0] = 1e6
    bent = bend_mesh(rough, held, 10.0)
    still = ball.vertices[:, 0] > 0.1
    np.testing.assert_allclose(bent.vertices[still], rough.vertices[still], atol=1e-6)
    loose = np.full(len(ball.vertices), 0.03)
    found = [roughness(bend_mesh(rough, loose, stiffness)) for stiffness in (0.0, 0.1, 10.0)]
    assert found[0] == roughness(rough) > found[1] > found[2]


def test_a_plate_bends_no_more_than_it_must():
    """Oracle: between two held ends of a long strip lies the cubic of least bending, here a straight line."""
    length, width = 60, 12
    place = np.stack(np.meshgrid(np.arange(length), np.arange(width), indexing="ij"), axis=-1).reshape(-1, 2)
    bump = np.where((place[:, 0] > 20) & (place[:, 0] < 40), 0.6, 0.0)
    corner = (np.arange(length - 1)[:, None] * width + np.arange(width - 1)).ravel()
    faces = np.concatenate(
        [
            np.stack([corner, corner + width, corner + 1], 1),
            np.stack([corner + 1, corner + width, corner + width + 1], 1),
        ]
    )
    mesh = Mesh(np.column_stack([place, bump]).astype(float), faces)
    held = np.where((place[:, 0] <= 18) | (place[:, 0] >= 42), 1.0, 1e-5)
    inner = (place[:, 1] > 2) & (place[:, 1] < width - 3)
    assert np.abs(bend_mesh(mesh, held, 100.0).vertices[inner, 2]).max() < 0.1


def test_depth_holds_what_it_lies_on_and_the_floor_what_stands_there():
    slab = make_slab()
    mesh = extract_surface(slab, GRID)
    top = np.abs(mesh.vertices[:, 2] - 15.5 * GRID.spacing) < 0.1 * GRID.spacing
    top &= np.abs(mesh.vertices[:, :2]).max(axis=1) < 0.35
    foot = mesh.vertices[:, 2] < 0.5 * GRID.spacing
    right = support_vertices(mesh, confirm(slab), FLOOR)
    wrong = support_vertices(mesh, confirm(slab, farther=4 * GRID.spacing), FLOOR)
    unsure = support_vertices(mesh, confirm(slab, trust=0.0), FLOOR)
    assert right[top].min() == 1 and wrong[top].max() < 0.2 and unsure[top].max() == 0.03
    assert foot.any()
    for support in (right, wrong, unsure):
        assert (support[foot] == 1).all()
