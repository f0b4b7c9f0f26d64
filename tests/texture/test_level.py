"""Exact and property: corrections that make two photographs equal at their seam."""

import numpy as np
import pytest
from painted_ball import CAMERA, ball, look_from

from threedfs.texture.level import level_seams

VIEWS = [look_from(0.0), look_from(np.pi)]


def level(mesh, chosen, levels):
    """Level photographs of one grey level each; return what is added."""
    images = {view.name: np.full((*CAMERA.shape, 3), grey, np.uint8) for view, grey in zip(VIEWS, levels, strict=True)}
    return level_seams(mesh, VIEWS, chosen, images.__getitem__)


@pytest.fixture(scope="module")
def halves():
    """A ball, one half of whose faces is painted from either side."""
    mesh = ball(3)
    return mesh, np.where(mesh.vertices[mesh.faces].mean(axis=1)[:, 0] > 0, 0, 1)


def test_equal_photographs_need_no_correction(halves):
    """Exact."""
    mesh, chosen = halves
    np.testing.assert_allclose(level(mesh, chosen, (100, 100)), 0, atol=1e-3)


def test_both_sides_of_a_seam_become_equal_and_what_is_far_from_it_stays(halves):
    """Property: each side gives way by a half; what differs by 30 differs by little, and the ends keep their own."""
    mesh, chosen = halves
    added = level(mesh, chosen, (100, 130))
    painted = added + np.where(chosen == 0, 100, 130)[:, None, None]
    on_seam = np.intersect1d(mesh.faces[chosen == 0], mesh.faces[chosen == 1])
    apart = [painted[(chosen == side)[:, None] & np.isin(mesh.faces, on_seam)].mean() for side in (0, 1)]
    assert 0 < apart[1] - apart[0] < 5 and sum(apart) / 2 == pytest.approx(115, abs=1)
    ends = np.abs(mesh.vertices[mesh.faces][..., 0]) > 0.49
    assert np.abs(added[ends]).max() < 0.3 * np.abs(added).max()


def test_corrections_are_one_at_each_vertex_of_a_photograph(halves):
    """Exact: no step within it."""
    mesh, chosen = halves
    added = level(mesh, chosen, (100, 130))
    for side in (0, 1):
        corners, vertex = added[chosen == side].reshape(-1, 3), mesh.faces[chosen == side].ravel()
        low, high = np.full((len(mesh.vertices), 3), np.inf), np.full((len(mesh.vertices), 3), -np.inf)
        np.minimum.at(low, vertex, corners)
        np.maximum.at(high, vertex, corners)
        assert (high - low)[np.unique(vertex)].max() == 0


def test_faces_of_no_photograph_have_the_whole_colour_of_those_beside(halves):
    """Exact: of one colour all around, that colour."""
    mesh, chosen = halves
    blank = mesh.vertices[mesh.faces].mean(axis=1)[:, 2] < -0.2
    added = level(mesh, np.where(blank, -1, chosen), (100, 100))
    np.testing.assert_allclose(added[blank], 100, atol=1e-3)
    np.testing.assert_allclose(added[~blank], 0, atol=1e-3)
