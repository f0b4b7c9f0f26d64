"""Exact and property: where the pieces of a mesh lie in its texture."""

import numpy as np
import pytest
from painted_ball import ball, cut_ball, ring

from threedfs.geometry.projection import project
from threedfs.texture.charts import cut_charts, pack
from threedfs.texture.choose import adjacent_faces

MARGIN = 2


@pytest.fixture(scope="module")
def cut(photos):
    """A ball, its views, the view of each face, and the charts."""
    return cut_ball(photos, 4)


def count_covers(place, size, shape):
    """Count how many rectangles cover each texel."""
    covers = np.zeros(shape, np.int64)
    for (column, row), (columns, rows) in zip(place, size, strict=True):
        assert column >= 0 and row >= 0 and column + columns <= shape[1] and row + rows <= shape[0]
        covers[row : row + rows, column : column + columns] += 1
    return covers


@pytest.mark.parametrize("seed", range(20))
def test_rectangles_do_not_overlap_and_lie_inside(seed):
    """Property: and they fill more than half of the texture."""
    generator = np.random.default_rng(seed)
    size = generator.integers(5, [80, 40], (generator.integers(1, 120), 2))
    place, shape = pack(size)
    covers = count_covers(place, size, shape)
    assert covers.max() == 1
    assert len(size) < 20 or covers.mean() > 0.5


def test_one_rectangle_is_the_texture():
    """Exact."""
    place, shape = pack(np.array([[7, 5]]))
    assert place.tolist() == [[0, 0]] and shape == (5, 7)


def test_charts_do_not_overlap_and_hold_their_faces_with_a_margin(cut):
    _, _, _, atlas = cut
    assert count_covers(atlas.place, atlas.size, atlas.shape).max() == 1
    low, high = atlas.place[atlas.chart][:, None], (atlas.place + atlas.size - 1)[atlas.chart][:, None]
    assert (atlas.corners >= low + MARGIN).all() and (atlas.corners <= high - MARGIN).all()


def test_a_chart_is_a_connected_piece_of_one_view(cut):
    """Exact: faces side by side lie in one chart if and only if one view paints both."""
    mesh, _, chosen, atlas = cut
    np.testing.assert_array_equal(atlas.view[atlas.chart], chosen)
    pairs, _ = adjacent_faces(mesh)
    one, other = atlas.chart[pairs].T
    np.testing.assert_array_equal(one == other, np.equal(*chosen[pairs].T))
    assert set(atlas.view) == {-1, *range(8)}


@pytest.mark.parametrize("texels", [1.0, 1.5])
def test_a_chart_has_the_shape_that_its_view_shows(cut, texels):
    """Exact: as many texels for each pixel as are asked for, moved by whole texels."""
    mesh, views, chosen, _ = cut
    atlas = cut_charts(mesh, views, chosen, texels)
    for rank, view in enumerate(views):
        own = chosen == rank
        moved = atlas.corners[own] - texels * project(view, mesh.vertices[mesh.faces[own]])[0]
        for chart in np.unique(atlas.chart[own]):
            apart = moved[atlas.chart[own] == chart].reshape(-1, 2)
            np.testing.assert_allclose(apart, np.rint(apart[:1]).repeat(len(apart), axis=0), atol=1e-9)


def test_what_no_view_shows_is_laid_out_without_loss_of_shape(cut):
    """Property: faces of a blank chart keep their proportions, at about half the others' resolution."""
    mesh, _, chosen, atlas = cut

    def areas(corners):
        one, other = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        return np.abs(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]) / 2

    a, b, c = np.moveaxis(mesh.vertices[mesh.faces], 1, 0)
    share = areas(atlas.corners) / (np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2)
    blank = share[chosen < 0]
    assert np.sqrt(np.median(blank) / np.median(share[chosen >= 0])) == pytest.approx(0.5, abs=0.12)
    assert blank.min() > 0.5 * blank.max()


def test_a_mesh_that_no_view_shows_still_has_a_chart():
    """Property: of some size, all of it blank."""
    mesh = ball(2)
    atlas = cut_charts(mesh, ring(3), np.full(len(mesh.faces), -1), 1.0)
    assert atlas.view.tolist() == [-1] and min(atlas.shape) > 10
    assert np.isfinite(atlas.corners).all()
