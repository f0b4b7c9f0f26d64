"""What lies well inside the hull of masks: a ball seen by a ring of views."""

import numpy as np
import pytest
from test_distance import GRID, RADIUS, scene  # noqa: F401

from threedfs.hull.inside import find_inside
from threedfs.types import Plane

BELOW = Plane(np.array([0.0, 0, 1]), 0.6)
THROUGH = Plane(np.array([0.0, 0, 1]), 0.1)
"""The ball reaches under it."""


def points_at(radius):
    """Return points that far from the ball's centre."""
    directions = np.random.default_rng(2).normal(size=(200, 3))
    return radius * directions / np.linalg.norm(directions, axis=1, keepdims=True)


@pytest.mark.parametrize(("depth", "voxels", "held"), [(4.0, 6.0, True), (4.0, 1.5, False), (8.0, 6.0, False)])
def test_points_deeper_than_asked_lie_there(scene, depth, voxels, held):  # noqa: F811
    """Property: the ball's distance, to the half voxel by which the hull leaves it."""
    views, masks, valid = scene
    inside = find_inside(masks, views, valid, GRID, BELOW, depth=depth, tolerance=0.0)
    assert (inside.holds(points_at(RADIUS - voxels * GRID.spacing)) == held).mean() > 0.97


def test_nothing_lies_there_outside_of_the_grid_or_well_under_the_plane(scene):  # noqa: F811
    views, masks, valid = scene
    inside = find_inside(masks, views, valid, GRID, THROUGH, depth=4.0, tolerance=0.0)
    assert not inside.holds(np.array([[9.0, 0, 0], [0, 0, -0.7]])).any()
    assert not inside.holds(np.array([[0.0, 0, -0.16]])).any() and inside.holds(np.array([[0.0, 0, 0]])).all()
    assert inside.holds(np.zeros((0, 3))).shape == (0,)


def test_a_tolerance_bears_one_wrong_mask_of_twelve(scene):  # noqa: F811
    """Property: what it leaves is that of right masks, but for a tenth; without one a third of it is lost."""
    views, masks, valid = scene
    wrong = masks | {"03": np.roll(masks["03"], 30, axis=1)}
    left = []
    for tolerance in (0.1, 0.0):
        exact, found = (
            find_inside(shown, views, valid, GRID, BELOW, depth=4.0, tolerance=tolerance).deep
            for shown in (masks, wrong)
        )
        left.append((exact & found).sum() / (exact | found).sum())
    assert left[0] > 0.9 > 0.67 > left[1]
