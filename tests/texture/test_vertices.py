"""Exact: colours of vertices on a ball of a red and a blue half behind a plate, and how many views confirm them."""

import numpy as np
import pytest
import trimesh

from threedfs.geometry.faces import vertex_normals
from threedfs.geometry.projection import backproject_map
from threedfs.geometry.raycast import RayCaster
from threedfs.geometry.rigid import look_at
from threedfs.texture.vertices import ABSENT, color_vertices, confirm_vertices, sample_vertices
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


def sample(mesh, images, valid=None):
    whole = np.ones(CAMERA.shape, bool)
    return sample_vertices(mesh, VIEWS, images.__getitem__, lambda name: whole if valid is None else valid[name])


def paint(mesh, images, valid=None):
    return color_vertices(mesh, sample(mesh, images, valid))


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


def test_a_sample_is_the_pixel_that_shows_the_vertex_or_absent(images):
    """Exact: a vertex on a view's side has the colour of its half there; one on the far side has none."""
    mesh = ball()
    samples = sample(mesh, images)
    assert samples.shape == (len(VIEWS), len(mesh.vertices), 3)
    for view, found in zip(VIEWS, samples, strict=True):
        toward = mesh.vertices @ view.centre / np.linalg.norm(view.centre)
        assert (found[toward < 0] == ABSENT).all()
        # at half the radius and more, the ray is within 60 degrees of the normal
        near = (toward > 0.3) & (np.abs(mesh.vertices[:, 0]) > 0.05)
        np.testing.assert_array_equal(found[near], np.where(mesh.vertices[near, :1] > 0, RED, BLUE))


def test_a_lower_cosine_lets_a_view_see_more(images):
    """Property: from a grazing angle on, a view sees all that it sees squarely, and more."""
    mesh, valid = ball(), np.ones(CAMERA.shape, bool)
    few, many = (
        sample_vertices(mesh, VIEWS, images.__getitem__, lambda name: valid, cosine) < ABSENT for cosine in (0.5, 0.1)
    )
    assert (many | ~few).all() and many.sum() > 1.2 * few.sum()


def test_a_vertex_is_confirmed_where_all_views_agree_and_not_where_none_sees_it(images):
    """Exact: 1 where a half is seen, away from the other; 0 below, where no view looks."""
    mesh = ball()
    samples = sample(mesh, images)
    confirmed = confirm_vertices(samples)
    seen = (samples[..., 0] < ABSENT).any(axis=0)
    sure = seen & (np.abs(mesh.vertices[:, 0]) > 0.05)
    assert confirmed.dtype == np.float32 and sure.mean() > 0.5 and (confirmed[sure] == 1).all()
    assert (~seen).any() and (confirmed[~seen] == 0).all()


def test_a_vertex_is_not_confirmed_where_every_other_view_shows_something_else(images):
    """Property: what most views show agrees with itself, so that the share is about a half, and never near 1."""
    mesh = ball()
    painted_over = images | {view.name: np.full_like(images[view.name], 255) for view in VIEWS[::2]}
    samples = sample(mesh, painted_over)
    by_both = ((samples[::2, :, 0] < ABSENT).any(axis=0)) & ((samples[1::2, :, 0] < ABSENT).any(axis=0))
    confirmed = confirm_vertices(samples)[by_both]
    assert by_both.mean() > 0.4 and confirmed.max() < 0.7 and confirmed.mean() < 0.5
