"""Parameters of the surface stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter
from threedfs.params.smoothing import SmoothingSettings


@dataclass(frozen=True)
class SurfaceParams(SmoothingSettings):
    """How the method surface weighs confirmed depth against the hull of the masks."""

    longest_side: int = parameter(
        200,
        "voxels along the longest side of the box around the hull of the masks",
        unit="voxel",
        minimum=16,
        maximum=1000,
    )
    agree_from: float = parameter(
        2.0, "views that agree with a depth up to which it is not trusted for it", minimum=0.0
    )
    agree_full: float = parameter(8.0, "views that agree with a depth from which it is trusted fully", minimum=0.0)
    aslant_agree_from: float = parameter(
        5.0,
        "views that agree with a depth up to which its vote counts as squarely as it faces the surface",
        minimum=0.0,
    )
    aslant_agree_full: float = parameter(
        9.0, "views that agree with a depth from which its vote counts by aslant_from and aslant_full", minimum=0.0
    )
    aslant_from: float = parameter(
        0.3,
        "cosine between normal and ray up to which such a vote counts no more than others",
        minimum=0.0,
        maximum=1.0,
    )
    aslant_full: float = parameter(
        0.7, "cosine between normal and ray from which such a vote counts fully", minimum=0.0, maximum=1.0
    )
    mirrored_height: float = parameter(
        0.07,
        "height over the support plane up to which depth in the masks is taken for the plane's mirror image in an "
        "upright face, and believed as far as the object's depth is sure; on a sure one it is floor where few views "
        "agree; at 0 only what lies under the plane is either (a rim in the plane itself is floor at any value)",
        unit="height of the object",
        minimum=0.0,
        maximum=1.0,
    )
    matched: float = parameter(
        0.01,
        "photometric confidence from which the photographs of a pixel match, on an object whose depth is sure",
        equation="Eq. 11",
        minimum=0.0,
        maximum=1.0,
    )
    bare_matched: float = parameter(
        0.02,
        "the same on a bare object, and to say how sure its depth is; the more candidates depth has, the more pixels "
        "match by chance",
        equation="Eq. 11",
        minimum=0.0,
        maximum=1.0,
    )
    matched_from: float = parameter(
        0.1,
        "share of matched pixels around one up to which depth that few views see is not trusted",
        minimum=0.0,
        maximum=1.0,
    )
    matched_full: float = parameter(
        0.4,
        "share of matched pixels around one from which depth that no view contradicts is trusted fully, but of a "
        "round object",
        minimum=0.0,
        maximum=1.0,
    )
    matched_reach: float = parameter(
        0.05,
        "standard deviation of that neighbourhood",
        unit="length of the object in the image",
        exclusive_minimum=0.0,
        maximum=1.0,
    )
    sure_from: float = parameter(
        0.6, "mean trust in the object's depth up to which the object is bare", minimum=0.0, maximum=1.0
    )
    sure_full: float = parameter(
        0.85, "mean trust in the object's depth from which its depth is sure", minimum=0.0, maximum=1.0
    )
    free_contradicted: float = parameter(
        0.15,
        "where fewer keyframes have a surface before a depth than this, the space up to it is free among pixels whose "
        "photographs match, on an object whose depth is sure; 0 for nowhere",
        unit="share of all",
        minimum=0.0,
        maximum=1.0,
    )
    free_from: float = parameter(
        0.4,
        "share of the object's pixels around that match, up to which space is no freer than its depth is trusted",
        minimum=0.0,
        maximum=1.0,
    )
    free_full: float = parameter(0.6, "share of such pixels from which that space is free", minimum=0.0, maximum=1.0)
    free_textured: float = parameter(
        2.5,
        "factor on free_contradicted where nearly all photographs around match",
        minimum=1.0,
    )
    textured_from: float = parameter(
        0.6,
        "share of the object's pixels around that match, up to which no more keyframes than free_contradicted says may",
        minimum=0.0,
        maximum=1.0,
    )
    textured_full: float = parameter(
        0.8, "share of such pixels from which free_textured times as many may", minimum=0.0, maximum=1.0
    )
    lent_from: float = parameter(
        6.0,
        "views that agree with a depth from which other keyframes may adopt it",
        minimum=1.0,
    )
    adopted_within: float = parameter(
        0.015,
        "relative difference from a keyframe's own depth up to which it may",
        exclusive_minimum=0.0,
        maximum=1.0,
    )
    adopted_reach: float = parameter(
        0.006,
        "standard deviation of the neighbourhood over which what is adopted is averaged",
        unit="length of the object in the image",
        exclusive_minimum=0.0,
    )
    adopted_full: float = parameter(
        0.5,
        "share of matched pixels around one up to which depth that others have found is adopted fully; with "
        "adopted_until 0 nothing is",
        minimum=0.0,
        maximum=1.0,
    )
    adopted_until: float = parameter(
        0.7, "share of matched pixels around one from which a keyframe keeps its own depth", minimum=0.0, maximum=1.0
    )
    hull_trust: float = parameter(
        0.45,
        "trust that the hull of the masks counts as much as, against depth, on a bare object that is not round",
        minimum=0.0,
        maximum=1.0,
    )
    sure_hull_trust: float = parameter(0.3, "the same on an object whose depth is sure", minimum=0.0, maximum=1.0)
    hollow_depth: float = parameter(
        0.02,
        "distance inside the hull of the keyframes' masks from which a pixel's depth tells of a hollow",
        unit="longest side of the grid",
        exclusive_minimum=0.0,
        maximum=1.0,
    )
    hollow_agree: float = parameter(5.0, "other views that must agree with such a depth", minimum=1.0)
    round_full: float = parameter(
        0.05,
        "share of such pixels that so many views agree with, up to which a bare object is round: its hull counts as "
        "round_trust, and depth that only few views see not at all",
        minimum=0.0,
        maximum=1.0,
    )
    round_until: float = parameter(
        0.1, "share of such pixels from which it is not; with round_full 0, too, none ever is", minimum=0.0, maximum=1.0
    )
    round_trust: float = parameter(0.7, "hull_trust of a round object", minimum=0.0, maximum=1.0)
    sure_clip_share: float = parameter(
        0.7,
        "clip distance of an object whose depth is sure, as a share of that of fuse_object, which a bare one has",
        exclusive_minimum=0.0,
        maximum=1.0,
    )
    hull_tolerance: float = parameter(
        0.055, "share of the masks that may be wrong in the hull that is weighed", minimum=0.0, maximum=1.0
    )
    bare_tolerance: float = parameter(
        0.025,
        "the same of the masks that are cut around the surface so far, of a bare object that is not round: the fewer, "
        "the flatter are sides that few frames show edge-on",
        minimum=0.0,
        maximum=1.0,
    )
    bound_tolerance: float = parameter(
        0.15,
        "share of the masks that may be wrong in the hull that nothing leaves but what fills gaps",
        minimum=0.0,
        maximum=1.0,
    )
    held_share: float = parameter(
        0.3,
        "share of the keyframes, four at least, whose trusted depth must have the surface at a place before masks that "
        "lack it do not carve there; 0 for none ever",
        minimum=0.0,
        maximum=1.0,
    )
    held_height: float = parameter(
        6.0, "height above the support surface from which depth holds anything so", unit="voxel", minimum=0.0
    )
    gap_tolerance: float = parameter(
        0.2, "share of the masks that may be wrong in the hull that fills gaps", minimum=0.0, maximum=1.0
    )
    gap_views: int = parameter(
        2, "least views that show a voxel of the hull where nothing solid is before it is filled", minimum=1
    )
    gap_share: float = parameter(
        0.05,
        "share of the masks that show something which these views must be, where that is more",
        minimum=0.0,
        maximum=1.0,
    )
    gap_odds: float = parameter(
        2.0,
        "views that must show such a voxel for each that shows it well outside of its mask",
        minimum=0.0,
    )
    free_share: float = parameter(
        0.15,
        "share of the keyframes that must look at a place and find it free before it is, on a bare object; none must "
        "on a sure one",
        minimum=0.0,
        maximum=1.0,
    )
    stiffness: float = parameter(
        20.0,
        "how much the surface resists bending where no trusted depth holds it; 0 for not at all",
        minimum=0.0,
    )
    closing: float = parameter(
        1.0,
        "share by which pits and tunnels one or two voxels wide are closed on a bare object; none are on a sure one",
        minimum=0.0,
        maximum=1.0,
    )
    tunnel_width: float = parameter(
        4.0,
        "width up to which tunnels through the object are closed; 0 for none",
        unit="voxel",
        minimum=0.0,
        maximum=12.0,
    )
    hidden_tunnel_width: float = parameter(
        6.0,
        "the same where hardly any sky is seen, as inside the object but not between spines",
        unit="voxel",
        minimum=0.0,
        maximum=12.0,
    )
    medians: int = parameter(
        3,
        "times that the field becomes its median over a voxel and the 6 beside it: pits, spikes and handles go",
        minimum=0,
        maximum=10,
    )
    frames: int = parameter(
        60,
        "frames whose masks the surface so far gives, to shape it once more: all keyframes, and of their neighbours as "
        "many as there is room for; 0 for none",
        minimum=0,
    )
    outline_weight: float = parameter(
        6.0, "weight of the surface's silhouette in those masks", symbol="lambda_sil", equation="Eq. 23", minimum=0.0
    )
    outline_ramp: float = parameter(
        6.0,
        "distance to both sides of its outline over which that silhouette is soft, and pixels are labelled anew",
        unit="voxel of the object's grid",
        exclusive_minimum=0.0,
    )
    mask_ramp: float = parameter(
        2.0,
        "the same for the masks of the keyframes, which are cut last, around the finished surface",
        unit="voxel of the object's grid",
        exclusive_minimum=0.0,
    )
    light_reach: float = parameter(
        0.1,
        "in all these masks an image's light is compared with that of the picture of the support surface over so wide "
        "a neighbourhood, its standard deviation; 0 for one light in all images",
        unit="root of the object's area in the image",
        minimum=0.0,
        maximum=5.0,
    )
