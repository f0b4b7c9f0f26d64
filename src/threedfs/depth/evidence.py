"""What the images say about the depth of a keyframe: the cost volume, and how far to trust it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from threedfs.depth.candidates import space_candidates
from threedfs.depth.cost_volume import choose_patch_radius, compute_cost_volume
from threedfs.depth.weights import photometric_confidence, texture_confidence
from threedfs.depth.zncc import describe_patches, prepare_grey
from threedfs.types import Keyframe


@dataclass(frozen=True)
class Evidence:
    """Photometric evidence for the depth of a keyframe.

    Attributes
    ----------
    candidates : (D,) float64, depths, ascending, scene units
    cost_volume : (D, H, W) float32, photometric error in [0, 1] (Eq. 1)
    min_cost : (H, W) float32, its least value over the candidates (Eq. 12)
    confidence : (H, W) float64 in [0, 1], lambda_a (Eq. 11) times the trust in the patch's texture; 0 where the patch
        leaves the valid image
    """

    candidates: np.ndarray
    cost_volume: np.ndarray
    min_cost: np.ndarray
    confidence: np.ndarray


def gather_evidence(
    keyframe: Keyframe,
    read_image: Callable[[str], np.ndarray],
    read_valid: Callable[[str], np.ndarray],
    *,
    candidates: int,
    spacing: str,
    outside_step: float,
    patch_radius: int,
    variance_floor: float,
    missing_cost: float,
    confidence_falloff: float,
    texture_half_variance: float,
    track: Callable[[Iterable], Iterable] = iter,
    note: Callable[[str], None] = lambda message: None,
) -> Evidence:
    """Compare a keyframe with its neighbours at every depth candidate.

    Parameters
    ----------
    keyframe : Keyframe
    read_image : callable
        Gives the (H, W, 3) uint8 RGB image of a frame by its name; one at a time is held.
    read_valid : callable
        Gives the pixels of a frame that show the scene, (H, W) bool, by its name.
    track, note : callable
        Wrap the loop over neighbours, and take a message, to report progress.
    Others
        See `DepthParams`.
    """
    grey = prepare_grey(read_image(keyframe.view.name), read_valid(keyframe.view.name))
    depths = space_candidates(keyframe.near, keyframe.far, candidates, spacing, keyframe.within, outside_step)
    radius = patch_radius or choose_patch_radius(keyframe.neighbour_angle)
    note(f"patches of {2 * radius + 1}x{2 * radius + 1} px")
    cost_volume = compute_cost_volume(
        keyframe.view,
        grey,
        keyframe.neighbours,
        lambda view: prepare_grey(read_image(view.name), read_valid(view.name)),
        depths,
        patch_radius=radius,
        variance_floor=variance_floor,
        missing_cost=missing_cost,
        track=track,
    )
    min_cost = cost_volume.min(axis=0)
    patches = describe_patches(grey, radius, variance_floor)
    confidence = photometric_confidence(min_cost, confidence_falloff)
    confidence *= texture_confidence(patches.variance, texture_half_variance)
    confidence[~patches.complete] = 0
    return Evidence(depths, cost_volume, min_cost, confidence)
