"""Pixels of a mask that show the support surface in the object's shade."""

from __future__ import annotations

import cv2
import numpy as np

from threedfs.locate.mirrored import find_low
from threedfs.surface.keyframe_depth import KeyframeDepth
from threedfs.surface.trust import TrustRule
from threedfs.types import Support

_LEAST_SURENESS = 0.6
"""Of the object's depth: below, depth in the support plane may be a mirror image in the object itself."""
_FEW = 2
"""Views that agree with depth in the plane, up to which it is floor: on the object's own foot more do."""
_MOST = 0.5
"""Share of a mask from which that much floor cannot be: then depth is wrong, or the object as flat as its errors."""
_REACH = 0.01
"""Half of the least width of such a place, lengths of the object in the image: depth bends to the floor at any rim."""


def may_tell_floor(sureness: float) -> bool:
    """Say whether an object's depth is sure enough, as a whole, to tell floor from object."""
    return sureness >= _LEAST_SURENESS


def find_floor(found: KeyframeDepth, mask: np.ndarray, support: Support, rule: TrustRule) -> np.ndarray:
    """Return where a mask shows the support surface instead of the object, (H, W) bool.

    Not in the paper. Under an object the floor is dark, and colours take it for the object. Its depth lies in the
    support plane, but few views agree on it, as few look there.

    Parameters
    ----------
    found : KeyframeDepth
        Of an object whose depth is sure (`may_tell_floor`).
    mask : (H, W) bool
        Takes the place of its mask.
    support : Support
    rule : TrustRule
    """
    low = find_low(found.view, found.depth, support, rule.mirrored_height)
    width = 2 * max(1, round(_REACH * found.length)) + 1
    wide = cv2.morphologyEx(
        (low & (found.agree <= _FEW)).astype(np.uint8),
        cv2.MORPH_OPEN,
        np.ones((width, width), np.uint8),
        borderType=cv2.BORDER_CONSTANT,
        borderValue=0,
    )
    floor = mask & (wide > 0)
    return floor if floor.sum() < _MOST * mask.sum() else np.zeros_like(mask)
