"""Exact: what becomes of depth that shows the table in the lower half of a ball."""

import dataclasses

import numpy as np
import pytest

from threedfs.fusion.doubt import DoubtRule, doubt_mirrored, rate_shown
from threedfs.geometry.projection import backproject_map
from threedfs.types import Box, Plane, Support

RULE = DoubtRule(mirrored_height=0.05, mirrored_from=0.4, mirrored_full=0.8)
SUPPORT = Support(  # with a margin of 0.1, above as below
    Plane(np.array([0.0, 0, 1]), 0.0), Box(np.eye(3), np.array([-0.4, -0.4, -0.1]), np.array([0.4, 0.4, 0.6])), {}
)


@pytest.fixture
def votes(table):
    """Votes of three views of confidence 0.6; where the ball is lower than its middle they have the table's depth."""
    bare = dataclasses.replace(table, radius=1e-9)
    made, shown, mirrored = [], {}, {}
    for view in table.views[:3]:
        depth, plane = table.depth(view), bare.depth(view)
        shown[view.name] = depth < plane - 1e-6
        height = backproject_map(view, depth)[..., 2]
        mirrored[view.name] = shown[view.name] & (height < table.radius) & (height > 0.1 * table.radius)
        seen = np.where(mirrored[view.name], plane, depth).astype(np.float32)
        confidence = np.where(mirrored[view.name], 0.9, 0.6).astype(np.float32)
        made.append((view, seen, confidence, np.full(seen.shape, np.inf, np.float32)))
    return made, shown, mirrored


def test_sureness_is_that_of_the_rest_of_the_object(votes):
    """Exact: half way from 0.4 to 0.8, whatever the mirror images' confidence is."""
    made, shown, _ = votes
    assert rate_shown(made, shown, SUPPORT, RULE) == pytest.approx(0.5, abs=1e-6)
    nothing = {name: np.zeros_like(mask) for name, mask in shown.items()}
    assert rate_shown(made, nothing, SUPPORT, RULE) == 1


@pytest.mark.parametrize("sureness", [0.0, 0.4, 1.0])
def test_mirror_images_count_as_far_as_the_object_is_sure(votes, sureness):
    """Exact: in the ball's outline; the table's own depth counts as before."""
    made, shown, mirrored = votes
    doubted = list(doubt_mirrored(made, shown, SUPPORT, RULE, sureness))
    assert [vote[0].name for vote in doubted] == [vote[0].name for vote in made]
    for (view, depth, confidence, free), (_, same, less, nearer) in zip(made, doubted, strict=True):
        np.testing.assert_array_equal(depth, same)
        inside = mirrored[view.name]
        assert inside.sum() > 100
        np.testing.assert_allclose(less[inside], 0.9 * sureness, atol=1e-6)
        np.testing.assert_allclose(nearer[inside], sureness * depth[inside], rtol=1e-6)
        outside = ~shown[view.name]
        np.testing.assert_array_equal(less[outside], confidence[outside])
        np.testing.assert_array_equal(nearer[outside], free[outside])
