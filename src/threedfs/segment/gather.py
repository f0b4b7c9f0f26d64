"""From fused field, keyframes and depth to the evidence that the joint segmentation weighs (Sections 3.4.1, 3.4.2)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import cv2
import numpy as np
from scipy import ndimage

from threedfs.geometry.grid import world_from_index
from threedfs.geometry.projection import backproject_map
from threedfs.locate.find import Located
from threedfs.read_ahead import map_ahead
from threedfs.segment.color_model import lab_image
from threedfs.segment.energy import BACKGROUND, OBJECT
from threedfs.segment.evidence import ImageEvidence, VoxelEvidence
from threedfs.segment.initialise import (
    UNDECIDED,
    bound_object,
    decide_superpixels,
    first_voxel_labels,
    fix_voxels,
    normalised_height,
)
from threedfs.segment.outline import draw_voxels
from threedfs.segment.pairwise import link_voxels, superpixel_weights
from threedfs.segment.superpixels import Superpixels
from threedfs.segment.table import TablePicture, match_table, picture_table
from threedfs.types import Box, View, VoxelGrid

_SURE_LEVEL = -0.5
"""Field of voxels that hide the support surface for certain."""
_SURFACE_LEVEL = 0.25
"""How far below zero the field may be at a voxel that a confirmed depth is linked with; above zero it may be empty."""
_CONFIRMED = 0.5
"""Confidence from which a depth is."""


@dataclass(frozen=True)
class Scene:
    """What the stages before have found.

    Attributes
    ----------
    located : Located
        The object in the field, and the plane that it stands on.
    sdf : (nx, ny, nz) float32
        The field.
    box : Box
        The object's, standing on the plane.
    views : mapping of str to View
        By the name of the keyframe, like images (H, W, 3) uint8 RGB, which of their pixels show the scene (H, W) bool,
        superpixels, depth (H, W), its confidence (H, W) and semi-dense depth (H, W), NaN where there is none; the last
        only if superpixels are linked by it.
    """

    located: Located
    sdf: np.ndarray
    box: Box
    views: Mapping[str, View]
    images: Mapping[str, np.ndarray]
    valid: Mapping[str, np.ndarray]
    superpixels: Mapping[str, Superpixels]
    depth: Mapping[str, np.ndarray]
    confidence: Mapping[str, np.ndarray]
    semidense: Mapping[str, np.ndarray]


@dataclass(frozen=True)
class GatherRule:
    """How evidence is gathered; `SegmentParams` says more of each value."""

    outer_level: float
    outer_height: float
    outer_margin: int
    fill_outer: bool
    inner_level: float
    inner_pieces: str
    decided_share: float
    random_first: bool
    empty_level: float
    deepest: float
    silhouette_ramp: float
    table: bool
    table_reach: float
    roi: str
    pair_weight: float
    pair_edge: str
    pair_falloff: float
    surface_links: bool
    link_weight: float
    link_by_share: bool


@dataclass(frozen=True)
class Bounds:
    """Over-estimate, first guess and under-estimate of the object, and what hides the table, (nx, ny, nz) bool."""

    outer: np.ndarray
    guess: np.ndarray
    inner: np.ndarray
    hides: np.ndarray


class OuterRule(Protocol):
    """What bounds the object from outside; `SegmentParams` says more of each value."""

    outer_level: float
    outer_height: float
    outer_margin: int


def over_estimate(located: Located, sdf: np.ndarray, rule: OuterRule) -> np.ndarray:
    """Return what bounds the object from outside (3.4.2), (nx, ny, nz) bool, as `bound_object`.

    Parameters
    ----------
    located : Located
    sdf : (nx, ny, nz) float32
        The field that the object was located in.
    rule : OuterRule
    """
    raised = located.least_height + rule.outer_height * located.grid.spacing
    return bound_object(sdf, located.voxels, located.height > raised, rule.outer_level, rule.outer_margin)


def gather_voxels(scene: Scene, rule: GatherRule) -> tuple[VoxelEvidence, Bounds]:
    """Return the voxels' first labels, and what bounds the object.

    Differs from the paper: the under-estimate lies within the component that is the object, unless
    `SegmentParams.inner_pieces` says otherwise.
    """
    located, grid = scene.located, scene.located.grid
    guess, height = located.voxels, located.height
    outer = over_estimate(located, scene.sdf, rule)
    inner = outer & (scene.sdf < rule.inner_level)
    if rule.inner_pieces == "object":
        inner &= guess
    hides = guess & (scene.sdf < _SURE_LEVEL) & (height > located.least_height)
    normalised = normalised_height(height)
    fixed = fix_voxels(scene.sdf, normalised, empty_level=rule.empty_level, deepest=rule.deepest)
    first = first_voxel_labels(scene.sdf, guess, fixed)
    return VoxelEvidence(grid, scene.sdf, normalised, fixed, first), Bounds(outer, guess, inner, hides)


def picture_support(scene: Scene, bounds: Bounds, rule: GatherRule, threads: int = 1) -> TablePicture | None:
    """Return how the support surface looks around the object, where keyframes show it bare; None if not wanted."""
    if not rule.table:
        return None
    hides = draw_voxels(bounds.hides, scene.located.grid, scene.views, threads)
    covered = {name: cv2.dilate(mask.astype(np.uint8), np.ones((5, 5))) > 0 for name, mask in hides.items()}
    around = scene.box.grow(rule.table_reach * scene.box.longest)
    solid = world_from_index(scene.located.grid, np.argwhere(bounds.hides))
    return picture_table(scene.images, scene.views, covered, scene.valid, scene.located.plane, solid, around, threads)


def box_of_grid(grid: VoxelGrid) -> Box:
    """Return the box that a grid covers, from face to face."""
    low = grid.axes @ grid.origin - grid.spacing / 2
    return Box(grid.axes, low, low + grid.spacing * np.array(grid.shape))


def pixels_at(box: Box, view: View, length: float) -> float:
    """Return how many pixels of a view a length, scene units, takes up at the middle of a box."""
    return length * view.camera.fx / float(view.cam_from_world[2] @ np.append(box.centre, 1))


def gather_images(
    scene: Scene,
    volume: VoxelEvidence,
    bounds: Bounds,
    table: TablePicture | None,
    rule: GatherRule,
    rng: np.random.Generator,
    threads: int = 1,
) -> dict[str, ImageEvidence]:
    """Return the evidence of each keyframe, by its name.

    Parameters
    ----------
    scene : Scene
    volume, bounds
        As `gather_voxels` returns them.
    table : TablePicture or None
        As `picture_support` returns it.
    rule : GatherRule
    rng : numpy.random.Generator
        Draws first labels, where they are random.
    threads : int
        Cores used; the result does not depend on it.
    """
    outer, guess, inner = (
        draw_voxels(voxels, scene.located.grid, scene.views, threads)
        for voxels in (bounds.outer, bounds.guess, bounds.inner)
    )
    drawn = {name: rng.random(scene.superpixels[name].count) < 0.5 for name in scene.views} if rule.random_first else {}
    region = scene.box if rule.roi == "box" else box_of_grid(scene.located.grid)

    def gather(name: str) -> ImageEvidence:
        superpixels, view = scene.superpixels[name], scene.views[name]
        over = ndimage.binary_fill_holes(outer[name]) if rule.fill_outer else outer[name]
        decided = decide_superpixels(superpixels, over, inner[name], rule.decided_share)
        guessed = drawn[name] if rule.random_first else superpixels.share(guess[name]) > 0.5
        first = np.where(decided == UNDECIDED, np.where(guessed, OBJECT, BACKGROUND), decided).astype(np.uint8)
        points = backproject_map(view, scene.depth[name])
        outside = np.isfinite(scene.depth[name]) & ~region.contains(points)
        pairs, weight = _link(scene, volume, name, points, rule)
        return ImageEvidence(
            view,
            scene.images[name],
            superpixels,
            decided,
            first,
            superpixels.share(outside),
            rule.pair_weight * superpixel_weights(superpixels, rule.pair_falloff, rule.pair_edge),
            pairs,
            weight,
            pixels_at(scene.box, view, rule.silhouette_ramp * scene.located.grid.spacing),
            match_table(lab_image(scene.images[name]), *table.predict(view)) if table else None,
        )

    return dict(zip(scene.views, map_ahead(gather, scene.views, threads=threads), strict=True))


def _link(scene, volume, name, points, rule):
    """Return the links (M, 2) of a keyframe's superpixels with open voxels, and their weights (M,); none of weight 0.

    A superpixel that the trimap decides ties the voxels that it shows to its label.
    """
    if rule.link_weight == 0:
        return np.empty((0, 2), np.int64), np.empty(0, np.float32)
    shown = scene.superpixels[name].index >= 0
    if rule.surface_links:
        shown &= (scene.confidence[name] > _CONFIRMED) & np.isfinite(scene.depth[name])
    else:
        points = backproject_map(scene.views[name], scene.semidense[name])
        shown &= np.isfinite(scene.semidense[name])
    rows, columns = np.nonzero(shown)
    pairs, share = link_voxels(scene.superpixels[name], points[rows, columns], rows, columns, scene.located.grid)
    kept = volume.fixed.reshape(-1)[pairs[:, 1]] == UNDECIDED
    if rule.surface_links:
        near = scene.sdf.reshape(-1)[pairs[:, 1]]
        kept &= (near <= 0) & (near > -_SURFACE_LEVEL)
    weight = rule.link_weight * (share[kept] if rule.link_by_share else np.ones(kept.sum()))
    return pairs[kept], weight.astype(np.float32)
