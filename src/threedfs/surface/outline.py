"""The object's mask in a frame, cut close around a surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from threedfs.object.silhouettes import draw_silhouette
from threedfs.segment.appearance import Appearance
from threedfs.segment.frame_mask import mask_frame
from threedfs.segment.gather import pixels_at
from threedfs.segment.refine import RefineRule
from threedfs.surface.floor import find_floor
from threedfs.surface.keyframe_depth import KeyframeDepth
from threedfs.surface.trust import TrustRule
from threedfs.types import Mesh, Support, View


@dataclass(frozen=True)
class OutlineRule:
    """How masks are cut around a surface.

    Attributes
    ----------
    refine : RefineRule
        Of the pixels near the outline.
    light_reach : float
        See `mask_frame`.
    trust : TrustRule
        Says what depth is floor (`find_floor`).
    """

    refine: RefineRule
    light_reach: float
    trust: TrustRule


def cut_around(
    surface: Mesh,
    view: View,
    image: np.ndarray,
    valid: np.ndarray,
    ramp: float,
    appearance: Appearance,
    support: Support,
    rule: OutlineRule,
    depth: KeyframeDepth | None = None,
) -> np.ndarray:
    """Return the object's mask (H, W) bool in a frame, within reach of a surface's own outline.

    Not in the paper.

    Parameters
    ----------
    surface : Mesh
        The object, as far as it is known.
    view : View
    image : (H, W, 3) uint8 RGB
    valid : (H, W) bool
        Pixels that show the scene.
    ramp : float
        Reach to both sides of the outline, scene units at the object.
    appearance : Appearance
        What the joint segmentation has learnt.
    support : Support
        Where the object stands.
    rule : OutlineRule
    depth : KeyframeDepth, optional
        Of the frame, if it is a keyframe and its depth can tell floor from object (`may_tell_floor`): the mask is
        then without floor.
    """
    reach = pixels_at(support.box, view, ramp)
    own = draw_silhouette(surface, view)
    mask = mask_frame(view, image, valid, own, reach, appearance, rule.refine, rule.light_reach)
    return mask if depth is None else mask & ~find_floor(depth, mask, support, rule.trust)
