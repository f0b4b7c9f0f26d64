"""The object's mesh, volume, silhouettes and masks from its fused field."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from threedfs.errors import UserError
from threedfs.io.frames import read_frames
from threedfs.io.keyframes import read_keyframes
from threedfs.io.meshes import write_mesh
from threedfs.io.outlines import write_outlines
from threedfs.io.point_clouds import read_semidense_points
from threedfs.io.poses import read_poses
from threedfs.io.volumes import Volume, read_support, read_volume, write_volume
from threedfs.job import Job
from threedfs.locate.component import choose_component, mark_points
from threedfs.locate.fixation import find_fixation, viewing_distance
from threedfs.locate.height import add_foot, height_above, least_height
from threedfs.object.extract import extract_surface
from threedfs.object.field import mask_field
from threedfs.params.object import ObjectParams


def run(
    *,
    field: Path,
    support: Path,
    keyframes: Path,
    poses: Path,
    frames: Path,
    semidense: list[Path],
    mesh: Path,
    volume: Path,
    silhouettes: Path,
    masks: Path,
    method: str,
    params: ObjectParams,
    job: Job,
) -> None:
    """Read the field on the object's grid; write the object alone as mesh, volume and masks."""
    fused = read_volume(field)
    grid = fused.grid
    place = read_support(support)
    entries = read_keyframes(keyframes)
    views = [entry.view for entry in entries.values()]
    fixation = find_fixation(views, place.box.centre)
    clearance = least_height(params.clearance, params.noise_clearance, grid.spacing, place.figures["plane_noise"])
    height = height_above(place.plane, grid)
    holds = np.zeros(grid.shape, bool)
    for cloud in read_semidense_points(entries, semidense, params.point_deviation):
        mark_points(grid, cloud, holds)
    chosen = choose_component(
        (fused.sdf < 0) & (fused.seen > 0) & (height > clearance),
        grid,
        holds & (height > clearance),
        fixation,
        reach=params.object_reach * viewing_distance(views, fixation),
    )
    if chosen is None:
        raise UserError(
            f"{field}: expected a solid above the support plane with semi-dense points on it, found none; the depth "
            "maps disagree on the object (shiny, transparent or without texture?), or object.clearance is above it."
        )
    owned = add_foot(chosen.voxels, height, grid, place.plane, clearance)
    alone = mask_field(fused.sdf, owned, height, grid.spacing)
    surface = extract_surface(alone, grid)
    job.progress.note(f"{method}: {len(surface.faces)} triangles, {chosen.rivals} other components left out")
    write_mesh(mesh, surface)
    write_volume(volume, Volume(grid, alone, fused.seen), job.header)
    posed, source_shape = read_poses(poses), read_frames(frames).source_shape
    whole = {view.name: view for view in posed.views}
    write_outlines(silhouettes, masks, surface, views, whole, posed.distortion, source_shape, job.header)
