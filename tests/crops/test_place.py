"""Exact, property: where crops lie, how large they are, and the depths searched in them."""

import numpy as np
import pytest

from threedfs.crops.depth_range import expect_crop_range
from threedfs.crops.place import cut_view, find_window, place_crops, shrink_view
from threedfs.geometry.projection import project
from threedfs.types import Box, Camera, Keyframe, View

CAMERA = Camera(1280, 960, 1000.0, 1000.0, 640.0, 480.0)
BOX = Box(np.eye(3), np.array([-0.2, -0.1, -0.1]), np.array([0.2, 0.1, 0.1]))


def view_from(distance, across=0.0, name="a"):
    """A camera that looks along z at the origin's plane from a distance, moved sideways."""
    pose = np.eye(4)
    pose[:3, 3] = (across, 0.0, distance)
    return View(name, CAMERA, pose)


@pytest.mark.parametrize("pixels", [5_000, 20_000, 60_000])
def test_crops_hold_the_box_and_have_pixels_of_one_size_there(pixels):
    views = [view_from(1.5), view_from(2.5, 0.3), view_from(4.0)]
    crops = place_crops(views, BOX.corners(), 0.05, pixels)
    for crop in crops:
        places, _ = project(crop, BOX.corners())
        assert (places >= -0.5).all()
        assert (places <= np.array([crop.camera.width, crop.camera.height]) - 0.5).all()
    areas = [crop.camera.width * crop.camera.height for crop in crops]
    assert np.mean(areas) <= pixels * 1.05  # sides are rounded up to whole pixels
    sizes = np.array([crop.cam_from_world[2, 3] / crop.camera.fx for crop in crops])
    native = np.array([view.cam_from_world[2, 3] / view.camera.fx for view in views])
    assert sizes == pytest.approx(np.maximum(native, sizes.min()), rel=1e-9)


def test_pixels_are_never_finer_than_the_source():
    (crop,) = place_crops([view_from(2.0)], BOX.corners(), 0.05, 10**9)
    assert crop.camera.fx == CAMERA.fx
    assert crop.camera.cx % 1 == 0  # whole pixels are cut out


def test_a_crop_and_its_frame_see_a_point_at_the_same_place():
    view = view_from(2.0, 0.1)
    window = find_window(view, BOX.corners(), 0.05)
    crop = cut_view(view, window, 0.37)
    point = np.array([[0.05, -0.02, 0.03]])
    whole, part = project(view, point)[0], project(crop, point)[0]
    assert part == pytest.approx((whole + 0.5 - (window.left, window.top)) * 0.37 - 0.5, abs=1e-9)


def test_a_crop_ends_at_the_frame():
    window = find_window(view_from(1.0, 0.55), BOX.corners(), 0.05)
    assert window.right == CAMERA.width
    assert window.left > 0


@pytest.mark.parametrize(
    "view", [view_from(1.0, 5.0), view_from(0.05), view_from(-2.0)], ids=["beside", "inside", "behind"]
)
@pytest.mark.parametrize("others", [[], [view_from(1.5), view_from(2.5)]], ids=["alone", "among others"])
def test_a_frame_that_does_not_show_the_box_is_taken_whole(view, others):
    """Property: with an area as that of the crops, to which it makes no difference."""
    assert find_window(view, BOX.corners(), 0.05) is None
    whole, *crops = place_crops([view, *others], BOX.corners(), 0.05, 20_000)
    assert whole.camera.width / whole.camera.height == pytest.approx(CAMERA.width / CAMERA.height, rel=0.01)
    assert whole.camera.fx / CAMERA.fx == pytest.approx(whole.camera.width / CAMERA.width, rel=0.01)
    assert whole.camera.width * whole.camera.height == pytest.approx(20_000, rel=0.02)
    if others:
        assert [crop.camera for crop in crops] == [
            crop.camera for crop in place_crops(others, BOX.corners(), 0.05, 20_000)
        ]


def test_whole_frames_keep_their_aspect():
    assert shrink_view(view_from(2.0), 320).camera.shape == (240, 320)
    assert shrink_view(view_from(2.0), 4000).camera == CAMERA


def test_the_depth_range_holds_the_box_and_what_is_seen_behind_it():
    view = cut_view(view_from(2.0), find_window(view_from(2.0), BOX.corners(), 0.05), 0.5)
    behind = np.column_stack([np.zeros(100), np.zeros(100), np.linspace(0.0, 1.0, 100)])
    beside = np.column_stack([np.full(100, 3.0), np.zeros(100), np.full(100, 9.0)])
    found = expect_crop_range(Keyframe(view, (), 0.1, 20.0), np.vstack([behind, beside]), BOX.corners(), 0.95, 1.2, 1.2)
    assert found.near == pytest.approx(0.95 * 1.9)
    assert found.far == pytest.approx(1.2 * 2.97, rel=1e-3)  # what lies beside is not in the crop
    assert found.within == pytest.approx((1.9, 2.1))
    assert expect_crop_range(found, beside, BOX.corners(), 0.95, 1.2, 1.2).far == pytest.approx(1.2 * 2.1)
    nearer = Keyframe(view, (), 0.1, 2.6)
    assert expect_crop_range(nearer, behind, BOX.corners(), 0.95, 1.2, 1.2).far == pytest.approx(2.6)
    wider = Keyframe(view, (), 0.1, 2.6 * 1.5 / 1.2)  # the same points, and the far end of the frame at 1.5 of theirs
    assert expect_crop_range(wider, behind, BOX.corners(), 0.95, 1.2, 1.5).far == pytest.approx(2.6)
