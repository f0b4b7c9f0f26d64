"""The closed surface that agrees best with confirmed depth and the object's masks."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from threedfs.crops.place import measure_object
from threedfs.errors import UserError
from threedfs.fusion.fuse import VoteRule
from threedfs.hull.grid import lay_grid
from threedfs.hull.inside import find_inside
from threedfs.io.appearance import read_appearance
from threedfs.io.colored_meshes import write_colored_mesh
from threedfs.io.consistency import read_consistency
from threedfs.io.crops import CropStore, read_crops
from threedfs.io.depth_maps import read_depth_map
from threedfs.io.keyframes import read_keyframes, read_object_pixels
from threedfs.io.outlines import write_masks
from threedfs.io.poses import read_poses
from threedfs.io.segmentation import Segmentation, read_segmentation
from threedfs.io.volumes import read_support
from threedfs.job import Job
from threedfs.params.fuse_object import FuseObjectParams
from threedfs.params.rules import make_rule
from threedfs.params.schema import make_params
from threedfs.params.segment import SegmentParams
from threedfs.params.surface import SurfaceParams
from threedfs.read_ahead import map_ahead
from threedfs.segment.appearance import Appearance
from threedfs.segment.frame_mask import spread_frames
from threedfs.segment.refine import RefineRule
from threedfs.surface.adopt import AdoptRule
from threedfs.surface.complete import HullRule
from threedfs.surface.confirmed import ConfirmedDepth, confirm_depth
from threedfs.surface.floor import may_tell_floor
from threedfs.surface.keyframe_depth import KeyframeDepth
from threedfs.surface.outline import OutlineRule, cut_around
from threedfs.surface.shape import ShapeRule, shape_surface
from threedfs.surface.trust import TrustRule
from threedfs.surface.votes import ReachRule, start_votes
from threedfs.texture.vertices import color_vertices, confirm_vertices, sample_vertices
from threedfs.types import Mesh, Support, View


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
    scene = _open(labels, appearance, keyframes, depth, consistency, support, crops, params)
    confirmed = _confirm(scene, make_params(FuseObjectParams, fusion), params, job)
    outlining = _outline_rule(make_params(SegmentParams, segmentation), params)
    shaping = make_rule(ShapeRule, params, complete=make_rule(HullRule, params))
    # Few masks, of the joint cut: each may be wrong, whatever the object is.
    by_cut = replace(shaping, bare_tolerance=params.hull_tolerance)
    plane, valid = scene.support.plane, scene.valid
    surface = shape_surface(confirmed, plane, scene.cut.masks, scene.keyframes, valid, by_cut)
    if surface is not None and params.frames:
        outlines = _outline(scene, surface, scene.frames, params.outline_ramp, confirmed.sureness, outlining, job)
        surface = shape_surface(confirmed, plane, outlines, scene.frames, valid, shaping) or surface
    if surface is None:
        raise UserError(
            f"{labels}: expected masks that agree on where the object is, found that no place lies inside of enough of "
            "them; raise surface.bound_tolerance and surface.gap_tolerance, or use fused_sdf."
        )
    samples = sample_vertices(surface, list(scene.keyframes.values()), scene.images.image, valid.__getitem__)
    write_colored_mesh(mesh, surface, color_vertices(surface, samples), {"confirmed": confirm_vertices(samples)})
    found = f"depth is sure by {confirmed.sureness:.2f}, the shape round by {confirmed.roundness:.2f}"
    job.progress.note(f"{method}: {found}; {len(surface.faces)} triangles")
    drawn = _outline(scene, surface, scene.keyframes, params.mask_ramp, confirmed.sureness, outlining, job)
    posed, shape = read_poses(poses), scene.images.source_shape
    whole = {view.name: view for view in posed.views}
    write_masks(silhouettes, masks, drawn, scene.keyframes, whole, posed.distortion, shape, job.header)


@dataclass(frozen=True)
class _Scene:
    """What the stage reads; images and depth maps are read when asked for.

    Attributes
    ----------
    keyframes, frames : mapping of str to View
        Those with depth; and all that masks are cut in, keyframes among them.
    valid : mapping of str to (H, W) bool
        Pixels of all frames that show the scene.
    read_depth : callable
        Gives what is known of a keyframe's depth by its name.
    """

    cut: Segmentation
    appearance: Appearance
    support: Support
    images: CropStore
    keyframes: Mapping[str, View]
    frames: Mapping[str, View]
    valid: Mapping[str, np.ndarray]
    read_depth: Callable[[str], KeyframeDepth]


def _open(
    labels: Path,
    appearance: Path,
    keyframes: Path,
    depth: list[Path],
    consistency: Path,
    support: Path,
    crops: Path,
    params: SurfaceParams,
) -> _Scene:
    cut, entries, images = read_segmentation(labels), read_keyframes(keyframes), read_crops(crops)
    views = {name: entry.view for name, entry in entries.items()}
    if not any(cut.masks[name].any() for name in views):
        raise UserError(
            f"{labels}: expected masks of the object in the keyframes, found them all empty; the method surface has no "
            "outline to go by: use fused_sdf."
        )
    place, agreement = read_support(support), read_consistency(consistency)
    paths = {path.name.removesuffix(".zarr.zip"): path for path in depth}
    corners = place.box.corners()

    def read_depth(name: str) -> KeyframeDepth:
        found, said = read_depth_map(paths[name]), agreement.read(name)
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

    frames = spread_frames(entries.values(), images.names, params.frames)
    valid = {name: images.valid_of(name) for name in frames}
    return _Scene(cut, read_appearance(appearance), place, images, views, frames, valid, read_depth)


def _confirm(scene: _Scene, fusion: FuseObjectParams, params: SurfaceParams, job: Job) -> ConfirmedDepth:
    """Fuse the depth maps on a grid around the hull of the masks."""
    place, masks, views = scene.support, scene.cut.masks, scene.keyframes
    loosest = max(params.bound_tolerance, params.gap_tolerance)
    grid = lay_grid(place.box, place.plane, masks, views, scene.valid, loosest, params.longest_side)
    voting = make_rule(VoteRule, fusion)
    reaching = make_rule(ReachRule, fusion, sure_clip_share=params.sure_clip_share)

    def start(sureness: float):
        thickness = place.figures["thickness"]
        return start_votes(grid, sureness, thickness, scene.cut.grid.spacing, reaching, voting, job.threads)

    inside = find_inside(
        masks,
        views,
        scene.valid,
        grid,
        place.plane,
        depth=params.hollow_depth * params.longest_side,
        tolerance=params.hull_tolerance,
        threads=job.threads,
    )
    return confirm_depth(
        views,
        scene.read_depth,
        start,
        place,
        inside,
        make_rule(TrustRule, params),
        make_rule(AdoptRule, params),
        track=lambda names: job.progress.track(names, "keyframe"),
        threads=job.threads,
    )


def _outline_rule(segmentation: SegmentParams, params: SurfaceParams) -> OutlineRule:
    refine = make_rule(
        RefineRule,
        segmentation,
        silhouette_weight=params.outline_weight,
        label_weight=0.0,
        pair_weight=segmentation.refine_pair_weight,
        contrast=segmentation.refine_contrast,
    )
    return OutlineRule(refine, params.light_reach, make_rule(TrustRule, params))


def _outline(
    scene: _Scene,
    surface: Mesh,
    within: Mapping[str, View],
    ramp: float,
    sureness: float,
    rule: OutlineRule,
    job: Job,
) -> dict[str, np.ndarray]:
    """Return the masks of frames, cut within `ramp` voxels of the surface's own outline."""
    told = scene.keyframes if may_tell_floor(sureness) else {}
    reach = ramp * scene.cut.grid.spacing

    def cut(name: str) -> np.ndarray:
        image, valid = scene.images.image(name), scene.valid[name]
        depth = scene.read_depth(name) if name in told else None
        return cut_around(surface, within[name], image, valid, reach, scene.appearance, scene.support, rule, depth)

    found = job.progress.track(map_ahead(cut, within, threads=job.threads), "frame", len(within))
    return dict(zip(within, found, strict=True))
