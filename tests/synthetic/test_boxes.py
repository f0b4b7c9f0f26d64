"""Tests of cube, caddy and books, and of the textures of what lies around them."""

import numpy as np
import pytest
import trimesh

from threedfs.synthetic.objects.books import make_books
from threedfs.synthetic.objects.placing import about_z, side_of_box
from threedfs.synthetic.objects.rubik_cube import make_rubik_cube, scramble
from threedfs.synthetic.objects.teabox import make_teabox
from threedfs.synthetic.surfaces import pictured, scattered, stony, tiled

MAKERS = {"rubik_cube": make_rubik_cube, "teabox": make_teabox, "books": make_books}


@pytest.mark.parametrize("name", MAKERS)
def test_objects_are_closed_stand_on_the_table_and_have_their_size(name):
    solid = MAKERS[name](spacing=0.0022)
    mesh = trimesh.Trimesh(solid.mesh.vertices, solid.mesh.faces, process=False)
    assert mesh.is_watertight and mesh.volume > 0 and mesh.body_count == 1
    low, high = solid.mesh.vertices.min(axis=0), solid.mesh.vertices.max(axis=0)
    assert abs(low[2]) < 1e-3 and np.all(np.abs(low + high)[:2] < 0.01)
    size = {"rubik_cube": (0.057, 0.08), "teabox": (0.07, 0.14), "books": (0.15, 0.25)}[name]
    assert size[0] < np.max(high - low) < size[1]
    colour = solid.materials[0].texture(solid.mesh.vertices, np.full(len(solid.mesh.vertices), 1e-3))
    assert colour.shape == solid.mesh.vertices.shape and colour.min() >= 0 and colour.max() <= 1


def test_a_scramble_keeps_every_colour_nine_times_and_opposite_centres_opposite():
    colours = scramble(41)
    assert np.array_equal(np.bincount(colours.ravel()), [9] * 6)
    centres = colours[:, 1, 1]
    assert {frozenset(pair) for pair in centres.reshape(3, 2)} == {frozenset(p) for p in ((0, 1), (2, 3), (4, 5))}
    assert np.array_equal(scramble(3, moves=0), np.repeat(np.arange(6), 9).reshape(6, 3, 3))
    # A corner cubie shows three colours, of three axes.
    for x, y, z in np.ndindex(2, 2, 2):
        shown = colours[x, 2 * y, 2 * z], colours[2 + y, 2 * x, 2 * z], colours[4 + z, 2 * x, 2 * y]
        assert len({ink // 2 for ink in shown}) == 3


def test_sides_of_a_box_are_read_from_outside():
    points = np.array([[-1, 0.2, 0.3], [1, 0.2, 0.3], [0.2, -1, 0.3], [0.2, 1, 0.3], [0.2, 0.3, -1], [0.2, 0.3, 1]])
    side, flat = side_of_box(points, (1, 1, 1))
    assert np.array_equal(side, range(6))
    assert np.allclose(flat[:, :2], [[-0.2, 0.3], [0.2, 0.3], [0.2, 0.3], [-0.2, 0.3], [0.2, 0.3], [0.2, 0.3]])
    assert np.allclose(about_z(90) @ [1, 0, 0], [0, 1, 0])


TEXTURES = {
    "tiles": tiled((0.6, 0.6, 0.6), (0.3, 0.3, 0.3), 0.2, 0.004, seed=1),
    "stone": stony((0.5, 0.5, 0.5), (0.2, 0.2, 0.2), (0.3, 0.3, 0.3), 0.2, seed=2),
    "print": scattered((0.6, 0.6, 0.5), [(0.3, 0.1, 0.1), (0.1, 0.1, 0.3)], 0.05, seed=3),
    "postcard": pictured((0.07, 0.05), 0.006, seed=4),
}


@pytest.mark.parametrize("name", TEXTURES)
def test_textures_are_colours_that_calm_down_from_afar(name):
    rng = np.random.default_rng(0)
    points = np.column_stack([rng.uniform(-1, 1, (20000, 2)), np.zeros(20000)])
    near, far = (TEXTURES[name](points, np.full(len(points), size)) for size in (1e-4, 0.5))
    for colour in (near, far):
        assert colour.shape == (20000, 3) and colour.min() >= 0 and colour.max() <= 1
    if name != "postcard":  # of which a point so far away is no part
        assert far.std(axis=0).max() < 0.6 * near.std(axis=0).max()
        np.testing.assert_allclose(far.mean(axis=0), near.mean(axis=0), atol=0.08)


def test_plain_tiles_have_hardly_any_texture_between_their_joints():
    texture = TEXTURES["tiles"]
    inside = np.column_stack([np.random.default_rng(0).uniform(0.02, 0.18, (5000, 2)), np.zeros(5000)])
    colour = texture(inside, np.full(5000, 1e-3))
    assert colour.std() < 0.02 * colour.mean()
