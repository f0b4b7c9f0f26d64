"""Exact: which point of the mesh a texel shows."""

import numpy as np
import pytest
from painted_ball import cut_ball

from threedfs.geometry.projection import project
from threedfs.texture.charts import Atlas, cut_charts
from threedfs.texture.texels import locate_texels
from threedfs.types import Mesh


@pytest.fixture(scope="module")
def cut(photos):
    """A ball, its views, the view of each face, and the charts, of a texel to a pixel."""
    return cut_ball(photos, 3)


def triangle(*corners):
    """Lay one triangle into a texture of 12 by 12."""
    one = np.zeros((1, 2), np.int64)
    return Atlas((12, 12), np.zeros(1, np.int64), np.zeros(1, np.int64), one, one, np.array([corners], np.float64))


def test_texels_within_a_triangle_and_beside_it_are_found():
    """Exact: a right angle at (2, 2); one more column and row around it, held to its edges."""
    texels = locate_texels(triangle((2.0, 2.0), (6.0, 2.0), (2.0, 6.0)))
    places = set(zip(texels.row.tolist(), texels.column.tolist(), strict=True))
    inside = {(row, column) for row in range(2, 7) for column in range(2, 7) if row + column <= 8}
    assert inside < places
    assert all(1 <= row and 1 <= column and row + column <= 9.5 for row, column in places)
    assert texels.weights.min() >= 0
    np.testing.assert_allclose(texels.weights.sum(axis=1), 1, rtol=1e-6)
    mesh = Mesh(np.array([[0.0, 0, 0], [4, 0, 0], [0, 4, 0]]), np.array([[0, 1, 2]]))
    points = texels.interpolate(mesh, mesh.vertices)
    own = np.array([place in inside for place in zip(texels.row.tolist(), texels.column.tolist(), strict=True)])
    np.testing.assert_allclose(
        points[own], np.column_stack([texels.column, texels.row, 0 * texels.row])[own] - [2, 2, 0], atol=1e-6
    )


def test_a_triangle_of_no_area_shows_nothing():
    assert not len(locate_texels(triangle((2.0, 2.0), (4.0, 4.0), (6.0, 6.0))).face)


def test_a_point_is_where_its_view_shows_it(cut):
    """Property: projected, the points of one chart are about a whole number of pixels from their texels."""
    mesh, views, chosen, atlas = cut
    texels = locate_texels(atlas)
    inside = texels.weights.min(axis=1) > 1e-3
    points = texels.interpolate(mesh, mesh.vertices)
    for rank, view in enumerate(views):
        own = inside & (chosen[texels.face] == rank)
        # up to what perspective does within a face
        apart = np.column_stack([texels.column, texels.row])[own] - project(view, points[own])[0]
        assert np.abs(apart - np.rint(apart)).max() < 0.1


def test_every_face_has_texels_where_charts_are_fine(cut):
    mesh, views, chosen, _ = cut
    texels = locate_texels(cut_charts(mesh, views, chosen, 4.0))
    assert set(texels.face) == set(range(len(mesh.faces)))
