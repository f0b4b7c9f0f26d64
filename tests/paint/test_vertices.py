"""Colours of vertices on a ball with a red and a blue half, and a wall that hides a part of it."""

import numpy as np
import pytest
import trimesh

from threedfs.geometry.projection import backproject_map
from threedfs.geometry.raycast import RayCaster
from threedfs.geometry.rigid import look_at
from threedfs.paint.vertices import color_vertices, vertex_normals
from threedfs.types import Camera, Mesh, View

CAMERA = Camera(160, 160, 200.0, 200.0, 79.5, 79.5)
RED, BLUE, TABLE, SHINE = (200, 30, 30), (30, 30, 200), (90, 140, 90), (255, 255, 255)


def look_from(angle, height=0.3):
    centre = 2.5 * np.array([np.cos(angle), np.sin(angle), height])
    return View(f"{angle:.2f}", CAMERA, look_at(centre, np.zeros(3), np.array([0.0, 0, 1])))


VIEWS = [look_from(angle) for angle in np.linspace(0, 2 * np.pi, 9)[:-1]]


def ball():
    made = trimesh.creation.icosphere(subdivisions=4, radius=0.5)
    return Mesh(np.asarray(made.vertices), np.asarray(made.faces))


def photograph(mesh, view):
    """Render the ball: red where x > 0, blue elsewhere."""
    rays = (backproject_map(view, np.ones(CAMERA.shape)) - view.centre).reshape(-1, 3)
    hits = RayCaster(mesh).first_hits(np.broadcast_to(view.centre, rays.shape).copy(), rays)
    x = view.centre[0] + np.where(np.isfinite(hits.distance), hits.distance, 0) * rays[:, 0]
    image = np.where((x > 0)[:, None], RED, BLUE)
    return np.where((hits.triangle >= 0)[:, None], image, TABLE).reshape(*CAMERA.shape, 3).astype(np.uint8)


def paint(mesh, images, valid=None):
    whole = np.ones(CAMERA.shape, bool)
    return color_vertices(mesh, VIEWS, images.__getitem__, lambda name: whole if valid is None else valid[name])


@pytest.fixture(scope="module")
def images():
    mesh = ball()
    return {view.name: photograph(mesh, view) for view in VIEWS}


def test_each_half_has_its_colour(images):
    """Exact, but where the halves meet; what no view sees, below, has its neighbours' colours, not black."""
    mesh = ball()
    colors = paint(mesh, images)
    sure = np.abs(mesh.vertices[:, 0]) > 0.05
    sure &= mesh.vertices[:, 2] > -0.3
    expected = np.where(mesh.vertices[:, :1] > 0, RED, BLUE)
    np.testing.assert_array_equal(colors[sure], expected[sure])
    assert colors.sum(axis=1).min() > 200


@pytest.mark.parametrize("color", [(255, 31, 201), (0, 1, 254)])
def test_every_value_comes_back_as_it_was(images, color):
    """Exact: white, black and odd values, by an odd and an even number of views."""
    plain = {name: np.full_like(image, color) for name, image in images.items()}
    assert (paint(ball(), plain) == color).all()


def test_a_highlight_in_few_views_does_not_count(images):
    mesh = ball()
    shining = dict(images)
    shining[VIEWS[0].name] = np.full_like(images[VIEWS[0].name], SHINE[0])
    changed = (paint(mesh, shining) == SHINE).all(axis=1)
    assert changed.mean() < 0.03  # those that it alone sees


def test_what_is_hidden_is_not_painted_by_what_hides_it(images):
    """A plate before the ball is in the mesh too: the ball's vertices behind it keep their colours."""
    plate = trimesh.creation.box((0.02, 0.6, 0.6), transform=trimesh.transformations.translation_matrix([1, 0, 0]))
    whole = trimesh.util.concatenate([trimesh.creation.icosphere(subdivisions=4, radius=0.5), plate])
    mesh = Mesh(np.asarray(whole.vertices), np.asarray(whole.faces))
    shown = {view.name: photograph(mesh, view) for view in VIEWS}
    blocked = {name: np.where((image == RED).all(-1)[..., None], TABLE, image) for name, image in shown.items()}
    shown[VIEWS[0].name] = blocked[VIEWS[0].name].astype(np.uint8)
    colors = paint(mesh, shown)
    behind = np.linalg.norm(mesh.vertices - (0.5, 0, 0), axis=1) < 0.1
    assert behind.any() and not (colors[behind] == TABLE).all(axis=1).any()


def test_no_view_of_anything_gives_grey(images):
    nothing = {name: np.zeros(CAMERA.shape, bool) for name in images}
    assert (paint(ball(), images, nothing) == 128).all()


def test_normals_of_a_ball_point_outward():
    mesh = ball()
    assert (vertex_normals(mesh) * mesh.vertices).sum(axis=1).min() > 0.499
