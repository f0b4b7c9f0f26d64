"""Pixels of a mask that show the support surface in the object's shade."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import binary_opening

from threedfs.locate.mirrored import find_mirrored
from threedfs.surface.keyframe_depth import KeyframeDepth
from threedfs.surface.trust import SURE, TrustRule
from threedfs.types import Support

_REACH = 0.01
"""Half of the least width of such a place, lengths of the object in the image: depth bends to the floor at any rim."""


def find_floor(found: KeyframeDepth, support: Support, sureness: float, rule: TrustRule) -> np.ndarray:
    """Return where a keyframe sees the support surface, (H, W) bool, by the depth of an object that is sure of it.

    Not in the paper. Under an object the floor is dark, and colours take it for the object. Its depth lies in the
    support plane, but few views agree on it, as few look there; on the object's own foot many do. On a bare object such
    depth is a mirror image, and says nothing.

    Parameters
    ----------
    found : KeyframeDepth
    support : Support
    sureness : float
        Of the object's depth, in [0, 1] (`rate_sureness`).
    rule : TrustRule
    """
    if sureness < SURE:
        return np.zeros_like(found.mask)
    low = find_mirrored(found.view, np.ones_like(found.mask), found.depth, support, rule.mirrored_height)
    width = 2 * max(1, round(_REACH * found.length)) + 1
    return binary_opening(low & (found.agree <= rule.agree_from), np.ones((width, width)))
