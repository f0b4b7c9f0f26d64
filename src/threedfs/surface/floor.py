"""Pixels of a mask that show the support surface in the object's shade."""

from __future__ import annotations

import cv2
import numpy as np
from scipy import ndimage

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
_LEVEL = 0.005
"""Share of the object's height up to which depth is in the plane itself, and floor, however many views agree on it."""
_LEVEL_REACH = 0.02
"""Half of the least width of such a place, lengths of the object in the image: what is seen of a foot is narrower."""
_LEVEL_MOST = 0.1
"""Share of a mask from which that much of it cannot be such floor: views agree on what lies beyond a lost side, too."""


def may_tell_floor(sureness: float) -> bool:
    """Say whether an object's depth is sure enough, as a whole, to tell floor from object."""
    return sureness >= _LEAST_SURENESS


def find_floor(found: KeyframeDepth, mask: np.ndarray, support: Support, rule: TrustRule) -> np.ndarray:
    """Return where a mask shows the support surface instead of the object, (H, W) bool.

    Not in the paper. Under an object the floor is dark, and colours take it for the object. Its depth lies in the
    support plane, but few views agree on it, as few look there. Where many do, it is floor only in the plane itself,
    and no more than a rim. Floor goes on outside of the mask; what the object surrounds is a mirror image in it.

    Parameters
    ----------
    found : KeyframeDepth
        Of an object whose depth is sure (`may_tell_floor`).
    mask : (H, W) bool
        Takes the place of its mask.
    support : Support
    rule : TrustRule
    """
    shaded = find_low(found.view, found.depth, support, rule.mirrored_height) & (found.agree <= _FEW)
    level = find_low(found.view, found.depth, support, _LEVEL)
    level = mask & _open(level, _LEVEL_REACH * found.length)
    if level.sum() > _LEVEL_MOST * mask.sum():
        level = np.zeros_like(mask)
    floor = _keep_touching(mask & _open(shaded, _REACH * found.length) | level, ~mask)
    return floor if floor.sum() < _MOST * mask.sum() else np.zeros_like(mask)


def _open(places: np.ndarray, reach: float) -> np.ndarray:
    """Return what of places (H, W) bool is no narrower than twice `reach`, pixels."""
    width = 2 * max(1, round(reach)) + 1
    opened = cv2.morphologyEx(
        places.astype(np.uint8),
        cv2.MORPH_OPEN,
        np.ones((width, width), np.uint8),
        borderType=cv2.BORDER_CONSTANT,
        borderValue=0,
    )
    return opened > 0


def _keep_touching(places: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Return the pieces of `places` that touch `others`, at a corner at least, all (H, W) bool."""
    return places & ndimage.binary_propagation(others, np.ones((3, 3)), mask=places | others)
