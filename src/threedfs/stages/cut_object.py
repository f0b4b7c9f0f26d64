"""The object's mesh from labelled voxels: as they are, their largest piece, or the field that they cut out."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from threedfs.errors import UserError
from threedfs.hull.gaps import fit_masks
from threedfs.io.crops import read_crops
from threedfs.io.keyframes import read_keyframes
from threedfs.io.meshes import write_mesh
from threedfs.io.outlines import write_outlines
from threedfs.io.poses import read_poses
from threedfs.io.segmentation import Segmentation, read_segmentation
from threedfs.io.volumes import Volume, read_support, read_volume
from threedfs.job import Job
from threedfs.locate.height import height_above
from threedfs.object.extract import extract_surface
from threedfs.object.field import mask_field
from threedfs.object.smooth import smooth_mesh
from threedfs.params.cut_object import CutObjectParams
from threedfs.segment.energy import OBJECT
from threedfs.segment.outline import grow_voxels, largest_piece, surround_voxels
from threedfs.types import Plane, View


def run(
    *,
    labels: Path,
    field: Path | None,
    support: Path,
    keyframes: Path,
    poses: Path,
    crops: Path,
    mesh: Path,
    silhouettes: Path,
    masks: Path,
    method: str,
    params: CutObjectParams,
    job: Job,
) -> None:
    """Read labels, and the field where the method needs it; write mesh and masks."""
    cut = read_segmentation(labels)
    voxels = cut.voxels == OBJECT
    if not voxels.any():
        raise UserError(
            f"{labels}: expected voxels of the object, found none; the method {method} has nothing to mesh."
        )
    views = {name: entry.view for name, entry in read_keyframes(keyframes).items()}
    images = read_crops(crops)
    if method != "gc_2d3d_voxel":  # the paper names no such step for volumetric_gc, whose table pieces would count
        voxels = largest_piece(voxels)
    valid = {name: images.valid_of(name) for name in views}
    if field is None:
        surface = surround_voxels(voxels, cut.grid)
    else:
        surface = _cut_field(read_volume(field), cut, voxels, read_support(support).plane, views, valid, params, job)
    write_mesh(mesh, surface)
    job.progress.note(f"{method}: {voxels.sum()} voxels, {len(surface.faces)} triangles")
    posed = read_poses(poses)
    whole = {view.name: view for view in posed.views}
    write_outlines(
        silhouettes, masks, surface, list(views.values()), whole, posed.distortion, images.source_shape, job.header
    )


def _cut_field(
    fused: Volume,
    cut: Segmentation,
    voxels: np.ndarray,
    plane: Plane,
    views: dict[str, View],
    valid: dict[str, np.ndarray],
    params: CutObjectParams,
    job: Job,
):
    """Return the smoothed surface of the field inside the labels, slightly enlarged (Sections 3.5, 4.3)."""
    grid, sdf = fused.grid, fused.sdf
    height = height_above(plane, grid)
    owned = grow_voxels(voxels, params.dilation)
    if params.fit_masks:
        solid = owned & (sdf < 0) & (height > 0)
        sdf, filled = fit_masks(
            sdf,
            solid,
            height > 0,
            cut.masks,
            views,
            valid,
            grid,
            ramp=params.hull_ramp,
            tolerance=params.hull_tolerance,
            least_views=params.gap_views,
        )
        owned |= filled
        job.progress.note(f"{filled.sum()} voxels filled for gaps in the masks, {(solid & (sdf > 0)).sum()} carved")
    alone = mask_field(sdf, owned, height, grid.spacing, params.medians)
    return smooth_mesh(extract_surface(alone, grid), params.smoothing_steps, params.smoothing_contrast)
