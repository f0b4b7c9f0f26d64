"""The closed surface that agrees best with confirmed depth and the object's masks."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from threedfs.crops.place import measure_object
from threedfs.errors import UserError
from threedfs.fusion.fuse import VoteRule, limit_clip_distance, start_fusion
from threedfs.hull.distance import measure_hull
from threedfs.io.consistency import read_consistency
from threedfs.io.crops import read_crops
from threedfs.io.depth_maps import read_depth_map
from threedfs.io.keyframes import read_keyframes, read_object_pixels
from threedfs.io.meshes import write_mesh
from threedfs.io.outlines import write_outlines
from threedfs.io.poses import read_poses
from threedfs.io.segmentation import read_segmentation
from threedfs.io.volumes import read_support
from threedfs.job import Job
from threedfs.locate.height import height_above
from threedfs.object.extract import extract_surface
from threedfs.object.field import mask_field
from threedfs.object.smooth import smooth_mesh
from threedfs.params.fuse_object import FuseObjectParams
from threedfs.params.rules import make_rule
from threedfs.params.schema import make_params
from threedfs.params.surface import SurfaceParams
from threedfs.surface.complete import HullRule, complete_depth
from threedfs.surface.trust import TrustRule, trust_depth

_DEEPEST = -2.0
"""Voxels above the support plane from which the hull is measured."""


def run(
    *,
    labels: Path,
    keyframes: Path,
    depth: list[Path],
    consistency: Path,
    support: Path,
    poses: Path,
    crops: Path,
    mesh: Path,
    silhouettes: Path,
    masks: Path,
    method: str,
    fusion: Mapping[str, Any],
    params: SurfaceParams,
    job: Job,
) -> None:
    """Read depth, what other views say of it, and the masks of the joint segmentation; write mesh and masks.

    Not in the paper. Depth maps are fused once more on the object's grid, by the settings `fusion` of fuse_object, but
    each pixel counts by how well it is confirmed, and the hull of the masks votes among them everywhere. So a depth
    that nothing confirms carves nothing inside of the outline, and a hollow that photographs show is not filled.

    Raises
    ------
    UserError
        If the segmentation has no masks of the object.
    """
    cut, entries, images = read_segmentation(labels), read_keyframes(keyframes), read_crops(crops)
    views = {name: entry.view for name, entry in entries.items()}
    if not any(cut.masks[name].any() for name in views):
        raise UserError(
            f"{labels}: expected masks of the object in the keyframes, found them all empty; the method surface has no "
            "outline to go by: use fused_sdf."
        )
    place, trust = read_support(support), read_consistency(consistency)
    height = height_above(place.plane, cut.grid)
    fused_as = make_params(FuseObjectParams, fusion)
    clip = limit_clip_distance(
        fused_as.clip_distance, place.figures["thickness"], fused_as.thickness_share, cut.grid.spacing
    )
    hull, bound = measure_hull(
        cut.masks,
        views,
        {name: images.valid_of(name) for name in views},
        cut.grid,
        height > _DEEPEST * cut.grid.spacing,
        ramp=clip / cut.grid.spacing,
        tolerances=(params.hull_tolerance, params.bound_tolerance),
    )
    fused = start_fusion(
        cut.grid,
        clip,
        make_rule(VoteRule, fused_as),
        hidden_distance=fused_as.hidden_distance * cut.grid.spacing,
        threads=job.threads,
    )
    paths = {path.name.removesuffix(".zarr.zip"): path for path in depth}
    corners = place.box.corners()
    rule, confirmed = make_rule(TrustRule, params), []
    for name, view in job.progress.track(views.items(), "keyframe", len(views)):
        found, said = read_depth_map(paths[name]), trust.read(name)
        reach = params.matched_reach * (read_object_pixels(keyframes, name) or measure_object([view], corners) or 0.0)
        own = trust_depth(said.agree, said.confidence, found.confidence, cut.masks[name], reach, rule)
        if cut.masks[name].any():
            confirmed.append(float(own[cut.masks[name]].mean()))
        fused.add(view, found.depth, own)
    sdf = complete_depth(
        fused, hull, bound, float(np.mean(confirmed)), height > 0, cut.masks, views, make_rule(HullRule, params)
    )
    alone = mask_field(sdf, np.ones(cut.grid.shape, bool), height, cut.grid.spacing, params.medians)
    surface = smooth_mesh(extract_surface(alone, cut.grid), params.smoothing_steps, params.smoothing_contrast)
    write_mesh(mesh, surface)
    job.progress.note(
        f"{method}: {np.mean(confirmed):.0%} of the object's depth is confirmed; {len(surface.faces)} triangles"
    )
    posed = read_poses(poses)
    whole = {view.name: view for view in posed.views}
    write_outlines(
        silhouettes, masks, surface, list(views.values()), whole, posed.distortion, images.source_shape, job.header
    )
