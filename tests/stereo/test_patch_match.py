"""Exact and property tests of patch-match stereo on a slanted plane, and what it refuses to say."""

from dataclasses import replace

import numpy as np
import pytest
import scenes

from threedfs.depth.zncc import MISSING
from threedfs.stereo.patch_match import PatchRule, guess_planes, match_patches

RULE = PatchRule(radius=3, stride=1, likeness=40.0, variance_floor=1.0, least_variance=4.0, best_views=2)


def match(images=None, rule=RULE, seed=0, far=2.5, levels=2, measured=None, wanted=None):
    reference, *neighbours = scenes.views()
    images = images or scenes.grey_images()
    nothing = np.full(scenes.CAMERA.shape, np.nan)
    return match_patches(
        reference,
        images[reference.name],
        neighbours,
        [images[view.name] for view in neighbours],
        nothing if measured is None else measured,
        np.ones(scenes.CAMERA.shape, bool) if wanted is None else wanted,
        near=0.4,
        far=far,
        rule=rule,
        levels=levels,
        rounds=4,
        seed=seed,
    )


@pytest.mark.parametrize("levels", [1, 2])
def test_depth_and_slope_of_a_slanted_plane(levels):
    """Exact: inverse depth on a plane is affine in the pixel, and so are its slopes known."""
    found = match(levels=levels)
    truth = 1 / scenes.plane_depth(scenes.views()[0])
    sure = found.cost < 0.02
    assert sure.mean() > 0.7
    assert np.median(np.abs(found.inverse_depth / truth - 1)[sure]) < 0.003
    slope = scenes.NORMAL[:2] / scenes.OFFSET / scenes.CAMERA.fx
    assert np.median(np.abs(found.slope - slope)[sure]) < 0.2 * np.abs(slope).max()


def test_the_seed_alone_decides():
    """Property: the same seed gives the same bytes; another one other planes, at depths that agree."""
    first, again, other = match(), match(), match(seed=1)
    for name in ("inverse_depth", "slope", "cost"):
        assert getattr(first, name).tobytes() == getattr(again, name).tobytes()
    assert not np.array_equal(first.slope, other.slope)
    sure = (first.cost < 0.02) & (other.cost < 0.02)
    assert np.median(np.abs(first.inverse_depth / other.inverse_depth - 1)[sure]) < 0.002


def test_nothing_is_said_without_texture():
    """Rejection: patches without texture, and patches that leave the image, have no depth."""
    images = scenes.grey_images(blank=True)
    found = match(images)
    middle = np.s_[30:42, 40:56]
    assert np.isnan(found.inverse_depth[middle]).all() and (found.cost[middle] == 1).all()
    assert np.isnan(found.inverse_depth[:3]).all() and np.isfinite(found.inverse_depth[3:20, 3:-3]).mean() > 0.9


def test_missing_pixels_are_left_alone():
    """Rejection: where the images show nothing, as beyond the border of an undistorted image."""
    images = scenes.grey_images()
    for image in images.values():
        image[:, :20] = MISSING
    found = match(images)
    assert np.isnan(found.inverse_depth[:, :23]).all()
    assert (found.cost[10:-10, 40:-10] < 0.05).mean() > 0.8


def test_neighbours_of_other_shapes_find_the_same():
    """Exact: neighbours cut to parts of different shapes; the plane is found as in the whole images."""
    images = scenes.grey_images()
    reference, *neighbours = scenes.views()
    cut = [cut_view(view, images[view.name], 3 * n, 2 * n) for n, view in enumerate(neighbours)]
    assert len({image.shape for _, image in cut} | {images[reference.name].shape}) == len(neighbours)
    nothing, everything = np.full(scenes.CAMERA.shape, np.nan), np.ones(scenes.CAMERA.shape, bool)
    found = match_patches(
        reference,
        images[reference.name],
        [view for view, _ in cut],
        [image for _, image in cut],
        nothing,
        everything,
        near=0.4,
        far=2.5,
        rule=RULE,
        levels=2,
        rounds=4,
        seed=0,
    )
    truth = 1 / scenes.plane_depth(reference)
    sure = found.cost < 0.02
    assert sure.mean() > 0.5
    assert np.median(np.abs(found.inverse_depth / truth - 1)[sure]) < 0.003


def cut_view(view, image, left, top):
    """Take columns off the left, rows off the top, and half as many off the other sides."""
    right, bottom = image.shape[1] - left // 2, image.shape[0] - top // 2
    camera = replace(
        view.camera,
        width=right - left,
        height=bottom - top,
        cx=view.camera.cx - left,
        cy=view.camera.cy - top,
    )
    return replace(view, camera=camera), np.ascontiguousarray(image[top:bottom, left:right])


def test_only_wanted_pixels_are_matched():
    """Property: a part of the image finds there what the whole image does, and says nothing elsewhere."""
    wanted = np.zeros(scenes.CAMERA.shape, bool)
    wanted[10:-10, 15:-15] = True
    part, whole = match(wanted=wanted), match()
    assert np.isnan(part.inverse_depth[~wanted]).all() and (part.cost[~wanted] == 1).all()
    sure = wanted & (part.cost < 0.02) & (whole.cost < 0.02)
    assert sure[wanted].mean() > 0.7
    assert np.median(np.abs(part.inverse_depth / whole.inverse_depth - 1)[sure]) < 0.002


def test_depth_stays_in_its_range():
    """Property: a plane beyond the range is not found at a wrong place with a good cost."""
    found = match(far=0.7)
    known = np.isfinite(found.inverse_depth)
    assert (found.inverse_depth[known] >= 1 / 0.7 - 1e-9).all()
    assert (found.cost[10:-10, 10:-10] < 0.02).mean() < 0.1


def test_planes_start_from_what_is_measured():
    """Exact: measured inverse depth is kept, the rest lies in the range."""
    measured = np.full((4, 5), np.nan)
    measured[1, 2] = 0.77
    planes = guess_planes(measured, 0.5, 2.0, np.random.default_rng(0))
    assert planes[1, 2].tolist() == [0.77, 0, 0]
    assert ((planes[..., 0] >= 0.5) & (planes[..., 0] <= 2.0)).all()
