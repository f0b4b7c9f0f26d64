"""Depth that is the support plane's mirror image in an upright face of the object."""

from __future__ import annotations

import numpy as np

from threedfs.geometry.projection import backproject_map
from threedfs.types import Support, View


def find_mirrored(view: View, mask: np.ndarray, depth: np.ndarray, support: Support, share: float) -> np.ndarray:
    """Return where a mask shows the object, but its depth lies in the support plane or under it, (H, W) bool.

    Not in the paper. An upright mirror shows the plane in front of it as if it went on behind, and one that lies shows
    what is above it underneath. All views find it there and photographs match, so the face would be carved away.

    Parameters
    ----------
    view : View
    mask : (H, W) bool
        The object.
    depth : (H, W) float32
        Scene units, NaN where missing.
    support : Support
        Its box has a margin, as much below the plane as above the object.
    share : float
        Of the object's height over the plane, up to which depth counts as in the plane.
    """
    return mask & find_low(view, depth, support, share)


def find_low(view: View, depth: np.ndarray, support: Support, share: float) -> np.ndarray:
    """Return where depth lies in the support plane or under it, (H, W) bool; parameters as of `find_mirrored`."""
    tall = support.box.high[2] + support.box.low[2] + 2 * support.plane.offset
    return support.plane.distance(backproject_map(view, depth)) < share * tall


def believe_mirrored(mirrored: np.ndarray, sureness: float) -> np.ndarray:
    """Return what the trust in a depth map is to be multiplied by, (H, W) float32 in [0, 1].

    Not in the paper. On an object whose depth is sure it is the mask that is wrong: it holds shaded floor between legs.

    Parameters
    ----------
    mirrored : (H, W) bool
        See `find_mirrored`.
    sureness : float
        Of the object's depth, in [0, 1] (`rate_sureness`, or where no masks are known yet `rate_shown`).
    """
    return np.where(mirrored, np.float32(sureness), np.float32(1))
