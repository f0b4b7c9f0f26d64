"""What is known of an image before it is matted: object, background, and the band between."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from threedfs.errors import UserError
from threedfs.locate.find import Located
from threedfs.segment.gather import over_estimate
from threedfs.segment.outline import depth_inside, draw_voxels
from threedfs.types import View


@dataclass(frozen=True)
class Trimap:
    """Pixels that are known.

    Attributes
    ----------
    inner, outer : (H, W) bool
        All within `inner` is object, all without `outer` background; `inner` lies within `outer`.
    """

    inner: np.ndarray
    outer: np.ndarray

    @property
    def unknown(self) -> np.ndarray:
        """(H, W) bool."""
        return self.outer & ~self.inner


@dataclass(frozen=True)
class BoundsRule:
    """What bounds the object in a field; `SegmentParams` and `SpectralMattingParams` say more of each value."""

    outer_level: float
    outer_height: float
    outer_margin: int
    fill_outer: bool
    inner_level: float


def draw_trimaps(
    located: Located, sdf: np.ndarray, views: Mapping[str, View], valid: Mapping[str, np.ndarray], rule: BoundsRule
) -> dict[str, Trimap]:
    """Return the trimap of each view by silhouettes of over- and under-estimate of the object (Section 3.4.2).

    The over-estimate is that of the joint segmentation. What shows no scene is background.

    Parameters
    ----------
    located : Located
    sdf : (nx, ny, nz) float32
        The field that the object was located in.
    views : mapping of str to View
    valid : mapping of str to (H, W) bool
        Pixels that show the scene.
    rule : BoundsRule

    Raises
    ------
    UserError
        If nothing of the object is known for certain.
    """
    outer = over_estimate(located, sdf, rule)
    inner = outer & located.voxels & (sdf < rule.inner_level)
    if not inner.any():
        deepest = f"{sdf[located.voxels].min():.2f}" if located.voxels.any() else "none"
        raise UserError(
            f"spectral_matting: expected a part of the object where the field is below {rule.inner_level:g} to know "
            f"its components by, found none (lowest value {deepest}); raise spectral_matting.inner_level."
        )
    drawn = {what: draw_voxels(voxels, located.grid, views) for what, voxels in (("in", inner), ("out", outer))}
    found = {}
    for name in views:
        around = ndimage.binary_fill_holes(drawn["out"][name]) if rule.fill_outer else drawn["out"][name]
        around = around & valid[name]
        found[name] = Trimap(drawn["in"][name] & around, around)
    return found


def trimap_around(mask: np.ndarray, reach: float) -> Trimap:
    """Return the trimap whose band holds all that is within `reach` pixels of the outline of a mask (H, W) bool.

    A mask that is empty or full has no outline: nothing is unknown.
    """
    if mask.all() or not mask.any():
        return Trimap(mask, mask)
    depth = depth_inside(mask)
    return Trimap(depth > reach, depth > -reach)
