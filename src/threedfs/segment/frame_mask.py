"""Masks of any frame, by the surface so far and what the joint segmentation has learnt."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from threedfs.segment.alpha_expansion import expand
from threedfs.segment.appearance import Appearance
from threedfs.segment.color_model import lab_image
from threedfs.segment.energy import BACKGROUND, OBJECT, fold_given
from threedfs.segment.outline import depth_inside
from threedfs.segment.refine import RefineRule, color_unary, weigh_neighbours
from threedfs.segment.table import compare_table
from threedfs.segment.unaries import silhouette_unary, soften_silhouette
from threedfs.types import Keyframe, View


def spread_frames(keyframes: Iterable[Keyframe], names: Sequence[str], count: int) -> dict[str, View]:
    """Return the views of all keyframes, and of so many of their neighbours, at uniform steps, as `count` leaves room.

    Parameters
    ----------
    keyframes : iterable of Keyframe
    names : sequence of str
        Of all frames, in their order.
    count : int
    """
    entries = list(keyframes)
    own = {entry.view.name: entry.view for entry in entries}
    between = {view.name: view for entry in entries for view in entry.neighbours if view.name not in own}
    order = [name for name in names if name in between]
    room = min(max(count - len(own), 0), len(order))
    return own | {order[rank * len(order) // room]: between[order[rank * len(order) // room]] for rank in range(room)}


def mask_frame(
    view: View,
    image: np.ndarray,
    valid: np.ndarray,
    silhouette: np.ndarray,
    reach: float,
    appearance: Appearance,
    rule: RefineRule,
    light_reach: float = 0.0,
) -> np.ndarray:
    """Return the object's mask (H, W) bool in a frame, whether or not it took part in the segmentation.

    Not in the paper. As `refine_mask`, but without superpixels: the pixels near the outline of a surface are labelled
    by their colours, the picture of the support surface and the soft silhouette of that surface.

    Parameters
    ----------
    view : View
    image : (H, W, 3) uint8 RGB
    valid : (H, W) bool
        Pixels that show the scene.
    silhouette : (H, W) bool
        Of the surface.
    reach : float
        Pixels to both sides of the silhouette's outline over which it is soft.
    appearance : Appearance
    rule : RefineRule
        Its label weight has nothing to act on.
    light_reach : float
        Of the neighbourhood over which the light of an image is taken to be one (`compare_table`); 0 for one light in
        all images.
    """
    if not silhouette.any():
        return np.zeros_like(silhouette)
    depth = depth_inside(silhouette)
    inside = (np.abs(depth) <= max(reach, 1.0)) & valid
    lab, match = lab_image(image), None
    if appearance.table:
        clear = valid & (depth < -reach)
        match = compare_table(appearance.table, view, lab, clear, silhouette, light_reach).at(inside)
    share = soften_silhouette(silhouette, reach)[inside]
    unary = color_unary(appearance.colors, lab[inside], match, rule) + rule.silhouette_weight * silhouette_unary(share)
    pairs, weight = weigh_neighbours(lab, inside, rule)
    graph = fold_given(pairs, weight, silhouette.reshape(-1).astype(np.uint8), inside.reshape(-1), 2).with_costs(unary)
    own = silhouette[inside].astype(np.uint8)
    mask = silhouette & valid
    mask[inside] = expand(graph, expand(graph, own, OBJECT), BACKGROUND) == OBJECT
    return mask
