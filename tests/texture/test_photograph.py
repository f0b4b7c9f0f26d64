"""Exact: pictures of a mesh with colours at its vertices, and with a texture."""

import numpy as np
import pytest
from painted_ball import CAMERA, ball, look_from
from scipy.ndimage import binary_erosion

from threedfs.geometry.projection import backproject_map, project
from threedfs.geometry.rigid import look_at
from threedfs.texture.held_out import hold_out, spread_views
from threedfs.texture.photograph import photograph_texture, photograph_vertices
from threedfs.texture.textured import TexturedMesh
from threedfs.types import Mesh, View

VIEW = look_from(0.4)


def wall():
    """Make a square of 2 x 2 across the x axis, at x = 0."""
    corners = np.array([[0.0, -1, -1], [0, 1, -1], [0, 1, 1], [0, -1, 1]])
    return Mesh(corners, np.array([[0, 1, 2], [0, 2, 3]]))


def test_colours_of_vertices_are_interpolated_on_the_plane_not_in_the_image():
    """Exact: colours that are linear in space are those of the point that each pixel shows."""
    mesh = wall()
    picture, shown = photograph_vertices(mesh, 100 + 50 * mesh.vertices).take(VIEW)
    rays = backproject_map(VIEW, np.ones(CAMERA.shape)) - VIEW.centre
    points = VIEW.centre - VIEW.centre[0] / rays[..., :1] * rays
    inside = (np.abs(points[..., 1:]) < 0.999).all(axis=-1)
    assert (
        0.4 < shown.mean() and (shown[inside]).all() and not shown[(np.abs(points[..., 1:]) > 1.001).any(axis=-1)].any()
    )
    np.testing.assert_allclose(picture[shown], 100 + 50 * points[shown], atol=1e-3)
    assert (picture[~shown] == 0).all()


def test_a_texture_of_its_own_photograph_gives_the_photograph():
    """Exact but for the interpolation at the outline: each corner lies at the pixel that shows it."""
    mesh = ball(5)
    image = np.random.default_rng(0).integers(0, 256, (*CAMERA.shape, 3), np.uint8)
    textured = TexturedMesh(mesh, project(VIEW, mesh.vertices)[0][mesh.faces], image)
    picture, shown = photograph_texture(textured).take(VIEW)
    within = binary_erosion(shown, iterations=3)
    error = np.abs(picture[within] - image[within])
    # a triangle is laid flat in the texture, without perspective: it is a few pixels large
    assert shown.sum() > 5000 and error.mean() < 1


def test_a_mesh_that_is_not_in_the_picture_leaves_it_empty():
    """Exact: aside, and between two rays."""
    aside = View("aside", CAMERA, look_at(VIEW.centre, 3 * VIEW.centre[[1, 0, 2]] * [-1, 1, 0], np.array([0.0, 0, 1])))
    pixel = backproject_map(VIEW, np.full(CAMERA.shape, 2.0))[80, 80]
    beside = backproject_map(VIEW, np.full(CAMERA.shape, 2.0))[81, 81]
    small = Mesh(1e-4 * ball(2).vertices + (pixel + beside) / 2, ball(2).faces)
    for mesh, view in ((ball(2), aside), (small, VIEW)):
        textured = TexturedMesh(mesh, np.zeros((len(mesh.faces), 3, 2)), np.full((2, 2, 3), 200, np.uint8))
        for taker in (photograph_texture(textured), photograph_vertices(mesh, np.ones_like(mesh.vertices))):
            picture, shown = taker.take(view)
            assert not picture.any() and not shown.any()


@pytest.mark.parametrize(
    ("count", "step", "held"),
    [(12, 4, [2, 6, 10]), (10, 3, [1, 4, 7]), (29, 10, []), (30, 10, [5, 15, 25]), (9, 0, [])],
)
def test_one_of_every_so_many_is_held_out_of_many(count, step, held):
    """Exact; none where there are fewer than three steps."""
    assert hold_out([str(number) for number in range(count)], step) == [str(number) for number in held]


@pytest.mark.parametrize(("most", "kept"), [(1, [0]), (2, [0, 8]), (3, [0, 4, 8]), (5, [0, 2, 4, 6, 8])])
def test_few_of_many_views_are_spread_evenly(most, kept):
    """Exact; as many as there are, or more, are all."""
    views = [look_from(0.1 * number) for number in range(9)]
    assert spread_views(views, most) == [views[number] for number in kept]
    assert spread_views(views, 9) == spread_views(views, 99) == views


@pytest.mark.parametrize("most", range(1, 30))
def test_no_view_is_taken_twice(most):
    """Property."""
    views = [look_from(0.1 * number) for number in range(29)]
    names = [view.name for view in spread_views(views, most)]
    assert len(names) == len(set(names)) == most
