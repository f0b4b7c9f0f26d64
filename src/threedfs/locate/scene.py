"""The support plane and the object's box, found in the fused scene."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from threedfs.errors import UserError
from threedfs.locate.box import enclose_object, measure_thickness
from threedfs.locate.component import choose_standing_component, mark_points
from threedfs.locate.fixation import find_fixation, find_up, viewing_distance
from threedfs.locate.height import height_above
from threedfs.locate.support import SupportRule, find_support
from threedfs.locate.surface import zero_crossings
from threedfs.types import Support, View, VoxelGrid

_SAMPLE = 4000  # semi-dense points of a keyframe that take part in the search for the plane


@dataclass(frozen=True)
class SceneRule:
    """How plane and object are found, in voxels and viewing distances; `LocateParams` says more of each value."""

    plane_tolerance: float
    plane_doublings: int
    plane_reach: float
    plane_max_tilt: float
    plane_min_share: float
    plane_candidates: int
    clearance: float
    clearance_doublings: int
    object_reach: float
    bridge: int
    box_margin: float


def find_in_scene(
    grid: VoxelGrid,
    sdf: np.ndarray,
    seen: np.ndarray,
    views: Sequence[View],
    sparse: np.ndarray,
    clouds: Iterable[np.ndarray],
    rule: SceneRule,
    generator: np.random.Generator,
) -> tuple[Support, np.ndarray]:
    """Find the plane that the object stands on, a box around the object, and its voxels (nx, ny, nz) bool.

    Parameters
    ----------
    grid : VoxelGrid
    sdf, seen : (nx, ny, nz)
        The fused scene, and how many views see each voxel.
    views : sequence of View
    sparse : (N, 3) float64
        Sparse points, world.
    clouds : iterable of (M, 3) float64
        Semi-dense points of each keyframe, world.
    rule : SceneRule
    generator : numpy.random.Generator

    Raises
    ------
    UserError
        If there is no plane, or nothing with semi-dense points stands on it.
    """
    fixation = find_fixation(views, np.median(sparse, axis=0))
    distance = viewing_distance(views, fixation)
    sample, holds = [], np.zeros(grid.shape, bool)
    for cloud in clouds:
        mark_points(grid, cloud, holds)
        sample.append(generator.choice(cloud, min(len(cloud), _SAMPLE), replace=False))
    found = find_support(
        *zero_crossings(grid, sdf, seen),
        np.concatenate(sample),
        centres=np.stack([view.centre for view in views]),
        fixation=fixation,
        up=find_up(views, fixation),
        rule=SupportRule(
            tolerance=rule.plane_tolerance * grid.spacing,
            doublings=rule.plane_doublings,
            reach=rule.plane_reach * distance,
            max_tilt=rule.plane_max_tilt,
            min_share=rule.plane_min_share,
            candidates=rule.plane_candidates,
        ),
        generator=generator,
    )
    chosen = choose_standing_component(
        (sdf < 0) & (seen > 0),
        height_above(found.plane, grid),
        grid,
        holds,
        fixation,
        clearance=rule.clearance * grid.spacing,
        doublings=rule.clearance_doublings,
        reach=rule.object_reach * distance,
        bridge=rule.bridge,
    )
    if chosen is None:
        raise UserError(
            "No object was found above the support plane: expected a solid with semi-dense points on it, got none; "
            "an object lower than locate_object.clearance or without any texture is missed: lower "
            "locate_object.clearance, or film from nearer."
        )
    figures = {
        "plane_share": found.share,
        "plane_noise": found.noise,
        "plane_extent": found.extent,
        "thickness": measure_thickness(chosen.voxels, grid.spacing),
        "viewing_distance": distance,
        "object_voxels": float(chosen.voxels.sum()),
        "supported_voxels": float(chosen.support),
        "rival_components": float(chosen.rivals),
    }
    box = enclose_object(chosen.voxels, grid, found.plane, rule.box_margin)
    return Support(found.plane, box, figures), chosen.voxels
