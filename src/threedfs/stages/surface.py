"""The closed surface that agrees best with confirmed depth and the object's masks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from threedfs.crops.place import measure_object
from threedfs.errors import UserError
from threedfs.fusion.fuse import VoteRule
from threedfs.hull.grid import lay_grid
from threedfs.hull.inside import find_inside
from threedfs.io.appearance import read_appearance
from threedfs.io.colored_meshes import write_colored_mesh
from threedfs.io.consistency import read_consistency
from threedfs.io.crops import read_crops
from threedfs.io.depth_maps import read_depth_map
from threedfs.io.keyframes import read_keyframes, read_object_pixels
from threedfs.io.outlines import write_masks
from threedfs.io.poses import read_poses
from threedfs.io.segmentation import read_segmentation
from threedfs.io.volumes import read_support
from threedfs.job import Job
from threedfs.object.silhouettes import draw_silhouette
from threedfs.params.fuse_object import FuseObjectParams
from threedfs.params.rules import make_rule
from threedfs.params.schema import make_params
from threedfs.params.segment import SegmentParams
from threedfs.params.surface import SurfaceParams
from threedfs.read_ahead import map_ahead
from threedfs.segment.frame_mask import mask_frame, spread_frames
from threedfs.segment.gather import pixels_at
from threedfs.segment.refine import RefineRule
from threedfs.surface.adopt import AdoptRule
from threedfs.surface.complete import HullRule
from threedfs.surface.confirmed import confirm_depth
from threedfs.surface.floor import find_floor, may_tell_floor
from threedfs.surface.keyframe_depth import KeyframeDepth
from threedfs.surface.shape import ShapeRule, shape_surface
from threedfs.surface.trust import TrustRule
from threedfs.surface.votes import ReachRule, start_votes
from threedfs.texture.vertices import color_vertices, confirm_vertices, sample_vertices


def run(
    *,
    labels: Path,
    appearance: Path,
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
    segmentation: Mapping[str, Any],
    params: SurfaceParams,
    job: Job,
) -> None:
    """Read depth, what other views say of it, and the masks of the joint segmentation; write mesh and masks.

    Not in the paper. Depth maps of the keyframes are fused once more, on a grid around the hull of the masks, by the
    settings `fusion` of fuse_object, but each pixel counts by how well it is confirmed, and the hull of the masks votes
    among them everywhere. So a depth that nothing confirms carves nothing inside of the outline, and a hollow that
    photographs show is not filled. Where a keyframe's photographs do not match, it takes over what other views have
    found (`adopt_depth`). Then the surface so far outlines the object in more frames, and in the keyframes
    anew, by what the segmentation has learnt (weights of its settings `segmentation`), and the hull of these masks
    shapes it once more. The masks of the keyframes are cut once more, close around the finished surface.

    Raises
    ------
    UserError
        If the segmentation has no masks of the object, or they contradict each other everywhere.
    """
    cut, entries, images = read_segmentation(labels), read_keyframes(keyframes), read_crops(crops)
    views = {name: entry.view for name, entry in entries.items()}
    if not any(cut.masks[name].any() for name in views):
        raise UserError(
            f"{labels}: expected masks of the object in the keyframes, found them all empty; the method surface has no "
            "outline to go by: use fused_sdf."
        )
    place, trust = read_support(support), read_consistency(consistency)
    frames = spread_frames(entries.values(), images.names, params.frames)
    valid = {name: images.valid_of(name) for name in frames}
    loosest = max(params.bound_tolerance, params.gap_tolerance)
    grid = lay_grid(place.box, place.plane, cut.masks, views, valid, loosest, params.longest_side)
    fused_as = make_params(FuseObjectParams, fusion)
    paths = {path.name.removesuffix(".zarr.zip"): path for path in depth}
    corners = place.box.corners()
    voxel = cut.grid.spacing

    def read(name):
        found, said = read_depth_map(paths[name]), trust.read(name)
        length = read_object_pixels(keyframes, name) or measure_object([views[name]], corners) or 0.0
        return KeyframeDepth(
            views[name],
            cut.masks[name],
            length,
            found.depth,
            found.confidence,
            said.agree,
            said.too_far,
            said.confidence,
        )

    voting = make_rule(VoteRule, fused_as)
    reaching = make_rule(ReachRule, fused_as, sure_clip_share=params.sure_clip_share)

    def start(sureness):
        thickness = place.figures["thickness"]
        return start_votes(grid, sureness, thickness, voxel, reaching, voting, job.threads)

    trusted_as = make_rule(TrustRule, params)
    inside = find_inside(
        cut.masks,
        views,
        valid,
        grid,
        place.plane,
        depth=params.hollow_depth * params.longest_side,
        tolerance=params.hull_tolerance,
        threads=job.threads,
    )
    confirmed = confirm_depth(
        views,
        read,
        start,
        place,
        inside,
        trusted_as,
        make_rule(AdoptRule, params),
        track=lambda names: job.progress.track(names, "keyframe"),
        threads=job.threads,
    )
    shaping = make_rule(ShapeRule, params, complete=make_rule(HullRule, params))
    # Few masks, of the joint cut: each may be wrong, whatever the object is.
    by_cut = replace(shaping, bare_tolerance=params.hull_tolerance)
    surface = shape_surface(confirmed, place.plane, cut.masks, views, valid, by_cut)
    learnt, cut_as = read_appearance(appearance), make_params(SegmentParams, segmentation)
    refine = make_rule(
        RefineRule,
        cut_as,
        silhouette_weight=params.outline_weight,
        label_weight=0.0,
        pair_weight=cut_as.refine_pair_weight,
        contrast=cut_as.refine_contrast,
    )

    def outline(mesh, within, ramp):
        """Return the masks of frames, cut within reach of a mesh's own outline; those of keyframes without floor."""

        def cut_out(name):
            view = within[name]
            reach = pixels_at(place.box, view, ramp * voxel)
            own = draw_silhouette(mesh, view)
            mask = mask_frame(view, images.image(name), valid[name], own, reach, learnt, refine, params.light_reach)
            if name in views and may_tell_floor(confirmed.sureness):
                mask &= ~find_floor(read(name), mask, place, trusted_as)
            return mask

        found = job.progress.track(map_ahead(cut_out, within, threads=job.threads), "frame", len(within))
        return dict(zip(within, found, strict=True))

    if surface is not None and params.frames:
        outlines = outline(surface, frames, params.outline_ramp)
        surface = shape_surface(confirmed, place.plane, outlines, frames, valid, shaping) or surface
    if surface is None:
        raise UserError(
            f"{labels}: expected masks that agree on where the object is, found that no place lies inside of enough of "
            "them; raise surface.bound_tolerance and surface.gap_tolerance, or use fused_sdf."
        )
    seen_by = list(views.values())
    samples = sample_vertices(surface, seen_by, images.image, valid.__getitem__)
    write_colored_mesh(mesh, surface, color_vertices(surface, samples), {"confirmed": confirm_vertices(samples)})
    found = f"depth is sure by {confirmed.sureness:.2f}, the shape round by {confirmed.roundness:.2f}"
    job.progress.note(f"{method}: {found}; {len(surface.faces)} triangles")
    posed = read_poses(poses)
    whole = {view.name: view for view in posed.views}
    drawn = outline(surface, views, params.mask_ramp)
    write_masks(silhouettes, masks, drawn, views, whole, posed.distortion, images.source_shape, job.header)
