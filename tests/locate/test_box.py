"""The object's box: that it stands on the plane, holds the object, and is as small as it can be."""

import numpy as np
import pytest

from threedfs.geometry.grid import voxel_centres
from threedfs.locate.box import enclose_object, widen_support
from threedfs.types import Plane, Support, VoxelGrid

GRID = VoxelGrid(np.full(3, -1.0), 0.04, (50, 50, 50))
NORMAL = np.array([0.48, -0.36, 0.8])
PLANE = Plane(NORMAL, 0.3)


def slab(angle: float, sides: tuple[float, float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Return the voxels of a block that floats over the plane, turned about its normal, and its axes (3, 3)."""
    across = np.cross(NORMAL, [1.0, 0, 0]) / np.linalg.norm(np.cross(NORMAL, [1.0, 0, 0]))
    first = np.cos(angle) * across + np.sin(angle) * np.cross(NORMAL, across)
    axes = np.stack([first, np.cross(NORMAL, first), NORMAL])
    offset = (voxel_centres(GRID) + PLANE.offset * NORMAL) @ axes.T - [0, 0, 0.2 + sides[2] / 2]
    return (np.abs(offset) < np.array(sides) / 2).all(axis=-1), axes


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.2, 2.5])
def test_box_lies_along_a_block_and_stands_on_the_plane(angle):
    """Oracle: the block's own axes, to the raggedness of its voxels."""
    voxels, axes = slab(angle, (1.0, 0.4, 0.5))
    box = enclose_object(voxels, GRID, PLANE, margin=0.0)
    np.testing.assert_array_equal(box.axes[2], NORMAL)
    np.testing.assert_allclose(box.axes @ box.axes.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(box.axes) == pytest.approx(1)
    assert np.degrees(np.arccos(min(1, abs(box.axes[0] @ axes[0])))) < 3
    np.testing.assert_allclose(box.high[:2] - box.low[:2], [1.0, 0.4], atol=2 * np.sqrt(3) * GRID.spacing)
    assert box.low[2] == pytest.approx(-PLANE.offset - GRID.spacing / 2)
    assert box.high[2] == pytest.approx(-PLANE.offset + 0.7, abs=np.sqrt(3) * GRID.spacing)


def test_box_holds_every_voxel_and_its_margin():
    """Exact: whole voxels, corners and all; the margin is shared by both sides."""
    voxels, _ = slab(0.7, (0.9, 0.5, 0.3))
    corners = voxel_centres(GRID)[voxels][:, None] + GRID.spacing * (np.array(list(np.ndindex(2, 2, 2))) - 0.5)
    tight, wide = (enclose_object(voxels, GRID, PLANE, margin) for margin in (0.0, 0.4))
    assert tight.grow(1e-9).contains(corners).all()
    np.testing.assert_allclose(wide.high - tight.high, 0.2 * tight.longest)
    np.testing.assert_allclose(tight.low - wide.low, 0.2 * tight.longest)


def test_no_other_box_on_the_plane_has_a_smaller_footprint():
    """Oracle: all rectangles, degree by degree."""
    voxels, axes = slab(0.4, (0.9, 0.5, 0.3))
    voxels |= slab(1.3, (0.6, 0.3, 0.5))[0]
    box = enclose_object(voxels, GRID, PLANE, margin=0.0)
    corners = voxel_centres(GRID)[voxels][:, None] + GRID.spacing * (np.array(list(np.ndindex(2, 2, 2))) - 0.5)
    turns = np.radians(np.arange(90))
    first = np.outer(np.cos(turns), axes[0]) + np.outer(np.sin(turns), axes[1])
    second = np.cross(NORMAL, first)
    flat = corners.reshape(-1, 3)
    areas = np.ptp(flat @ first.T, axis=0) * np.ptp(flat @ second.T, axis=0)
    assert np.prod(box.high[:2] - box.low[:2]) <= areas.min() * (1 + 1e-9)
    assert box.high[0] - box.low[0] >= box.high[1] - box.low[1]


def test_one_voxel_has_a_box():
    """Exact: a footprint of one voxel spans a rectangle too, here a square along the axes."""
    voxels = np.zeros(GRID.shape, bool)
    voxels[20, 21, 22] = True
    box = enclose_object(voxels, GRID, Plane(np.array([0.0, 0, 1]), -GRID.axis(2)[22]), margin=0.0)
    np.testing.assert_allclose(box.high - box.low, GRID.spacing)
    np.testing.assert_allclose(np.abs(box.axes).max(axis=1), 1)


def test_a_box_is_enlarged_once_what_images_show_takes_up_most_of_its_margin():
    """Exact: kept for what stays inside, drawn anew around both for what does not, never lowered for what is below."""
    known, axes = slab(0.4, (0.6, 0.4, 0.3))
    support = Support(PLANE, enclose_object(known, GRID, PLANE, margin=0.35), {"plane_share": 0.5})
    along = voxel_centres(GRID) @ axes.T
    top = along[known][:, 2].max()
    own = 0.35 / (2 * 1.35) * support.box.longest

    def widen(share):
        column = (np.abs(along - along[known].mean(axis=0)) < 0.1)[..., :2].all(axis=-1)
        return widen_support(support, known, known | (column & (along[..., 2] < top + share * own)), GRID, 0.35)

    inside, beyond = widen(0.3), widen(1.6)
    assert inside.box is support.box
    assert inside.figures["box_enlarged"] == 1
    assert inside.figures["plane_share"] == 0.5
    assert beyond.figures["margin_used"] > 1 > inside.figures["margin_used"]
    assert beyond.figures["box_enlarged"] > 1
    assert beyond.box.high[2] > support.box.high[2] + own / 2
    nothing = widen_support(support, known, np.zeros_like(known), GRID, 0.35)
    assert nothing.box is support.box
