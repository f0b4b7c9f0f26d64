"""Exact: which masks a crop cuts off."""

import numpy as np
import pytest

from threedfs.crops.border import is_cut_off
from threedfs.types import Camera

WHOLE = Camera(640, 480, 500.0, 500.0, 320.0, 240.0)


def crop(left, top, width, height, scale=0.5):
    return Camera(
        int(width * scale),
        int(height * scale),
        WHOLE.fx * scale,
        WHOLE.fy * scale,
        (WHOLE.cx + 0.5 - left) * scale - 0.5,
        (WHOLE.cy + 0.5 - top) * scale - 0.5,
    )


@pytest.mark.parametrize("side", [np.s_[:, 0], np.s_[0], np.s_[:, -1], np.s_[-1]])
def test_a_mask_at_a_side_within_the_frame_is_cut_off(side):
    inner = crop(100, 100, 200, 200)
    mask = np.zeros(inner.shape, bool)
    mask[40:60, 40:60] = True
    assert not is_cut_off(mask, inner, WHOLE)
    mask[side] = True
    assert is_cut_off(mask, inner, WHOLE)


def test_a_mask_at_the_frames_own_side_is_not():
    whole = crop(0, 0, 640, 480)
    assert not is_cut_off(np.ones(whole.shape, bool), whole, WHOLE)
    corner = crop(0, 0, 200, 200)
    mask = np.zeros(corner.shape, bool)
    mask[:50, :50] = True
    assert not is_cut_off(mask, corner, WHOLE)
    mask[:, -1] = True
    assert is_cut_off(mask, corner, WHOLE)
