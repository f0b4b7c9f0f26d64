"""Find the support plane and the box of the object in the fused scene."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from threedfs.errors import UserError
from threedfs.io.keyframes import read_keyframes
from threedfs.io.point_clouds import read_semidense_points
from threedfs.io.points import read_points
from threedfs.io.volumes import Support, read_volume, write_support
from threedfs.job import Job
from threedfs.locate.box import enclose_object, measure_thickness
from threedfs.locate.component import choose_standing_component, mark_points
from threedfs.locate.fixation import find_fixation, find_up, viewing_distance
from threedfs.locate.height import height_above
from threedfs.locate.support import SupportRule, find_support
from threedfs.locate.surface import zero_crossings
from threedfs.params.locate import LocateParams

_SAMPLE = 4000  # semi-dense points of a keyframe that take part in the search for the plane


def run(
    *,
    scene: Path,
    keyframes: Path,
    points: Path,
    semidense: list[Path],
    support: Path,
    params: LocateParams,
    job: Job,
) -> None:
    """Read the scene's volume and the points; write the plane and the object's box."""
    volume = read_volume(scene)
    grid = volume.grid
    entries = read_keyframes(keyframes)
    views = [entry.view for entry in entries.values()]
    fixation = find_fixation(views, np.median(read_points(points).xyz, axis=0))
    distance = viewing_distance(views, fixation)
    rule = SupportRule(
        tolerance=params.plane_tolerance * grid.spacing,
        doublings=params.plane_doublings,
        reach=params.plane_reach * distance,
        max_tilt=params.plane_max_tilt,
        min_share=params.plane_min_share,
        candidates=params.plane_candidates,
    )
    generator = np.random.default_rng(job.seed)
    sample, holds = [], np.zeros(grid.shape, bool)
    for cloud in read_semidense_points(entries, semidense, params.point_deviation):
        mark_points(grid, cloud, holds)
        sample.append(generator.choice(cloud, min(len(cloud), _SAMPLE), replace=False))
    found = find_support(
        *zero_crossings(grid, volume.sdf, volume.seen),
        np.concatenate(sample),
        centres=np.stack([view.centre for view in views]),
        fixation=fixation,
        up=find_up(views, fixation),
        rule=rule,
        generator=generator,
    )
    height = height_above(found.plane, grid)
    chosen = choose_standing_component(
        (volume.sdf < 0) & (volume.seen > 0),
        height,
        grid,
        holds,
        fixation,
        clearance=params.clearance * grid.spacing,
        doublings=params.clearance_doublings,
        reach=params.object_reach * distance,
        bridge=params.bridge,
    )
    if chosen is None:
        raise UserError(
            "No object was found above the support plane: expected a solid with semi-dense points on it, got none; "
            "an object lower than locate.clearance or without any texture is missed: lower locate.clearance, or film "
            "from nearer."
        )
    box = enclose_object(chosen.voxels, grid, found.plane, params.box_margin)
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
    job.progress.note(
        f"support plane with {found.share:.0%} of the nearby upward-facing surface; object of {chosen.voxels.sum()} "
        f"voxels, {chosen.support} of them with semi-dense points, before {chosen.rivals} other components"
    )
    write_support(support, Support(found.plane, box, figures), job.header)
