"""Exact and property tests of the closed surface and its silhouettes."""

import cv2
import numpy as np
import pytest
import trimesh

from threedfs.errors import UserError
from threedfs.geometry.grid import cover_box, voxel_centres
from threedfs.geometry.projection import backproject_map
from threedfs.geometry.rigid import look_at
from threedfs.object.extract import enclosed_volume, extract_surface
from threedfs.object.silhouettes import draw_silhouette, draw_source_silhouette, rasterise
from threedfs.types import Box, Camera, Mesh, View

GRID = cover_box(Box(np.eye(3), np.array([-1.0, -1, -1]), np.array([1.0, 1, 1])), 50)
CENTRE = np.array([0.1, -0.05, 0.02])
RADIUS = 0.6


def ball(centre=CENTRE, radius=RADIUS):
    distance = np.linalg.norm(voxel_centres(GRID) - centre, axis=-1) - radius
    return np.clip(distance / (4 * GRID.spacing), -1, 1).astype(np.float32)


def check_closed(mesh):
    solid = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    assert solid.is_watertight
    assert solid.is_winding_consistent
    assert solid.body_count == 1
    assert enclosed_volume(mesh) > 0
    assert len(np.unique(mesh.faces)) == len(mesh.vertices), "a vertex without a face"
    assert solid.area_faces.min() > 0


def test_ball_is_closed_and_in_place():
    """Exact: vertices on the sphere to the error of linear interpolation, (spacing)^2 / (8 radius)."""
    mesh = extract_surface(ball(), GRID)
    check_closed(mesh)
    distance = np.linalg.norm(mesh.vertices - CENTRE, axis=1)
    np.testing.assert_allclose(distance, RADIUS, atol=GRID.spacing**2 / (8 * RADIUS) * 1.5)
    assert enclosed_volume(mesh) == pytest.approx(4 / 3 * np.pi * RADIUS**3, rel=0.005)


def test_normals_point_outward():
    """Property: every triangle of a ball faces away from its centre."""
    mesh = extract_surface(ball(), GRID)
    a, b, c = (mesh.vertices[mesh.faces[:, corner]] for corner in range(3))
    outward = (np.cross(b - a, c - a) * (a + b + c - 3 * CENTRE)).sum(axis=1)
    assert (outward > 0).all()


def test_closes_at_the_border_of_the_grid():
    """Property: an object that leaves the grid is closed where it leaves."""
    check_closed(extract_surface(ball(centre=np.array([0.0, 0.0, -0.9])), GRID))


def test_specks_and_cavities_are_left_out():
    """Property: one shell, the outer one."""
    field = ball()
    field[25:28, 23:26, 24:27] = 0.7
    field[2:4, 2:4, 2:4] = -0.5
    mesh = extract_surface(field, GRID)
    check_closed(mesh)
    assert enclosed_volume(mesh) == pytest.approx(4 / 3 * np.pi * RADIUS**3, rel=0.005)


@pytest.mark.parametrize("values", [(-1.0, 1.0), (-2.0, 0.0, 0.5, 2.0)])
def test_any_field_gives_a_closed_mesh(values):
    """Property: random fields, all ambiguous cells, ties and zeros, have exactly one face on each side of an edge."""
    for seed in range(10):
        field = np.random.default_rng(seed).choice(values, (12, 12, 12)).astype(np.float32)
        mesh = extract_surface(field, cover_box(Box(np.eye(3), np.zeros(3), np.ones(3)), 12))
        directed = np.concatenate([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]], mesh.faces[:, [2, 0]]])
        edges, uses = np.unique(directed, axis=0, return_counts=True)
        assert (uses == 1).all()
        assert np.array_equal(edges, np.unique(edges[:, ::-1], axis=0))
        assert enclosed_volume(mesh) > 0


def test_empty_field_is_told():
    """Rejection."""
    with pytest.raises(UserError, match="positive everywhere"):
        extract_surface(np.ones((4, 4, 4), np.float32), GRID)


UP = np.array([0, 0, 1.0])
VIEW = View(
    "a", Camera(320, 240, 300.0, 300.0, 160.0, 118.0), look_at(np.array([2.0, 1, 1]), CENTRE, np.array([0, 0, 1.0]))
)


def ball_outline(view):
    rays = backproject_map(view, np.ones(view.camera.shape)) - view.centre
    toward = CENTRE - view.centre
    along = (rays @ toward) / np.linalg.norm(rays, axis=-1)
    return along**2 >= toward @ toward - RADIUS**2


def overlap(a, b):
    return (a & b).sum() / (a | b).sum()


def test_silhouette_is_the_outline():
    """Oracle: the rays that meet the ball."""
    silhouette = draw_silhouette(extract_surface(ball(), GRID), VIEW)
    assert overlap(silhouette, ball_outline(VIEW)) > 0.995  # chords of the mesh cut off parts of the border's pixels


def test_source_silhouette_is_that_of_the_distorted_frame():
    """Oracle: the undistorted outline, looked up where each source pixel comes from."""
    mesh = extract_surface(ball(), GRID)
    assert overlap(draw_source_silhouette(mesh, VIEW, (0.0, 0.0), (240, 320)), draw_silhouette(mesh, VIEW)) == 1
    distortion = (-0.2, 0.05)
    source = draw_source_silhouette(mesh, VIEW, distortion, (480, 640))
    camera = VIEW.camera
    v, u = np.mgrid[:480, :640]
    imaged = np.stack([((u + 0.5) / 2 - 0.5 - camera.cx), ((v + 0.5) / 2 - 0.5 - camera.cy)], axis=-1) / camera.fx
    ideal = imaged.copy()
    for _ in range(60):  # fixed point of x = x_d / (1 + k1 r^2 + k2 r^4)
        square = (ideal**2).sum(axis=-1, keepdims=True)
        ideal = imaged / (1 + distortion[0] * square + distortion[1] * square**2)
    columns = (ideal[..., 0] * camera.fx + camera.cx).astype(np.float32)
    rows = (ideal[..., 1] * camera.fy + camera.cy).astype(np.float32)
    expected = cv2.remap(ball_outline(VIEW).astype(np.float32), columns, rows, cv2.INTER_LINEAR) > 0.5
    assert overlap(source, expected) > 0.99


def test_rasteriser_covers_what_it_should():
    """Exact: pixel centres on edges count, either way round, and triangles behind the camera do not."""
    pixels = np.array([[1.0, 1], [4, 1], [1, 4], [np.nan, np.nan], [20, 20]])
    expected = np.zeros((6, 6), bool)
    expected[1, 1:5] = expected[2, 1:4] = expected[3, 1:3] = expected[4, 1] = True
    for faces in ([[0, 1, 2]], [[0, 2, 1]], [[0, 1, 2], [0, 3, 4]]):
        assert (rasterise(pixels, np.array(faces), (6, 6)) == expected).all()


def test_object_beyond_the_image_is_cut():
    """Property: a view so near that the ball fills it marks every pixel."""
    near = View("b", VIEW.camera, look_at(CENTRE + np.array([0.7, 0, 0]), CENTRE, UP))
    assert draw_silhouette(extract_surface(ball(), GRID), near).all()


def test_volume_does_not_depend_on_where_the_mesh_is():
    """Property."""
    mesh = extract_surface(ball(), GRID)
    assert enclosed_volume(Mesh(mesh.vertices + 100, mesh.faces)) == pytest.approx(enclosed_volume(mesh))
