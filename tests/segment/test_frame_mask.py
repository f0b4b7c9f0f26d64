"""Property and exact: masks of frames by a surface's silhouette and learnt colours."""

from dataclasses import replace

import numpy as np
import pytest
from scene import make_scene
from scipy import ndimage
from test_joint import DEFAULTS, overlap, segment

from threedfs.params.rules import make_rule
from threedfs.params.segment import SegmentParams
from threedfs.segment.appearance import Appearance
from threedfs.segment.color_model import ColorModel, lab_image
from threedfs.segment.frame_mask import mask_frame, spread_frames
from threedfs.segment.refine import RefineRule
from threedfs.segment.table import TablePicture
from threedfs.types import Camera, Keyframe, View

RULE = make_rule(RefineRule, SegmentParams(silhouette_weight=3.0), label_weight=0.0, pair_weight=1.5, contrast=8.0)
REACH = 8.0


@pytest.fixture(scope="module")
def learnt():
    scene, truth = make_scene()
    _, cut = segment(scene, DEFAULTS)
    return scene, truth, Appearance(cut.colors, None)


@pytest.mark.parametrize("change", [ndimage.binary_erosion, ndimage.binary_dilation])
def test_colours_bring_a_wrong_outline_to_the_true_one(learnt, change):
    scene, truth, appearance = learnt
    for name, view in scene.views.items():
        start = change(truth[name], iterations=4)
        mask = mask_frame(view, scene.images[name], scene.valid[name], start, REACH, appearance, RULE)
        before, after = (overlap({name: m}, {name: truth[name]}) for m in (start, mask))
        assert after > 0.97 and after > before + 0.02


def test_a_table_in_another_light_is_no_object(learnt):
    scene, truth, appearance = learnt
    name, view = next(iter(scene.views.items()))
    start = ndimage.binary_dilation(truth[name], iterations=4)
    above = View(
        name, replace(view.camera, fx=1.0, fy=1.0, cx=0.0, cy=0.0), np.eye(4)
    )  # the picture's pixels are its own
    alike = appearance.colors.of_background  # colours alone tell nothing
    darker = lab_image(scene.images[name]) - np.float32([25, 0, 0])
    known, flat = np.ones(start.shape, bool), np.ones(start.shape, np.float32)
    picture = TablePicture(darker, flat, known, ~known, np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0]]))
    one_light, own_light = (
        mask_frame(
            above,
            scene.images[name],
            scene.valid[name],
            start,
            REACH,
            Appearance(ColorModel(alike, alike), picture),
            RULE,
            reach,
        )
        for reach in (0.0, 0.1)
    )
    worse, better = ((mask & ~truth[name]).sum() for mask in (one_light, own_light))
    assert 3 * better < worse


def test_far_from_the_outline_nothing_changes(learnt):
    scene, truth, appearance = learnt
    name, view = next(iter(scene.views.items()))
    mask = mask_frame(view, 0 * scene.images[name], scene.valid[name], truth[name], 3.0, appearance, RULE)
    changed = mask != truth[name]
    near = ndimage.binary_dilation(truth[name], iterations=4) & ~ndimage.binary_erosion(truth[name], iterations=4)
    assert not (changed & ~near).any()


def test_what_shows_nothing_is_no_object(learnt):
    scene, truth, appearance = learnt
    name, view = next(iter(scene.views.items()))
    none = np.zeros_like(truth[name])
    assert not mask_frame(view, scene.images[name], scene.valid[name], none, REACH, appearance, RULE).any()
    assert not mask_frame(view, scene.images[name], none, truth[name], REACH, appearance, RULE).any()


@pytest.mark.parametrize(("count", "between"), [(0, 0), (3, 0), (5, 2), (100, 7)])
def test_keyframes_come_first_and_the_others_are_spread(count, between):
    views = [View(f"{number:02d}", Camera(4, 4, 4.0, 4.0, 1.5, 1.5), np.eye(4)) for number in range(10)]
    keyframes = [Keyframe(views[at], tuple(views), 1.0, 2.0) for at in (0, 4, 8)]
    chosen = list(spread_frames(keyframes, [view.name for view in views], count))
    assert chosen[:3] == ["00", "04", "08"] and len(set(chosen)) == len(chosen) == 3 + between
    assert chosen[3:] == sorted(chosen[3:])
