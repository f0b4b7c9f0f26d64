"""Find the support plane and the box of the object in the fused scene."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from threedfs.geometry.grid import cut_grid
from threedfs.io.consistency import ConsistencyStore, read_consistency
from threedfs.io.crops import CropStore, read_crops
from threedfs.io.depth_maps import read_depth_map, read_edges
from threedfs.io.keyframes import read_keyframes
from threedfs.io.point_clouds import read_semidense_points
from threedfs.io.points import read_points
from threedfs.io.volumes import read_volume, write_support
from threedfs.job import Job
from threedfs.locate.box import widen_support
from threedfs.locate.find import stand_on
from threedfs.locate.scene import SceneRule, find_in_scene
from threedfs.params.locate import LocateParams
from threedfs.params.rules import make_rule
from threedfs.params.schema import make_params
from threedfs.params.segment import SegmentParams
from threedfs.read_ahead import map_ahead
from threedfs.segment.extent import find_extent
from threedfs.segment.gather import GatherRule, Scene
from threedfs.segment.joint import CutRule
from threedfs.segment.superpixels import Superpixels, split_image
from threedfs.types import Keyframe

_SUPERPIXEL, _COMPACTNESS = 16.0, 10.0
"""Area in pixels and compactness of superpixels in small images."""
_ROUNDS, _COLORS = 3, 20_000
"""Rounds of the coarse segmentation, and pixels drawn to learn colours from."""


_FIELD_WEIGHT = 1.0
"""Of the field, which may lack a part of the object, against what images show."""


def run(
    *,
    scene: Path,
    keyframes: Path,
    points: Path,
    crops: Path,
    semidense: list[Path],
    edges: list[Path],
    depth: list[Path],
    consistency: Path,
    support: Path,
    clearance: float,
    segmentation: Mapping[str, Any],
    params: LocateParams,
    job: Job,
) -> None:
    """Read the scene's volume, points and what its images show; write the plane and the object's box.

    `clearance` is the least height above the plane from which voxels may belong to the object, voxels; `segmentation`
    are the settings of the segment stage, by which images are asked for more of the object.
    """
    volume, entries = read_volume(scene), read_keyframes(keyframes)
    generator = np.random.default_rng(job.seed)
    found, known = find_in_scene(
        volume.grid,
        volume.sdf,
        volume.seen,
        [entry.view for entry in entries.values()],
        read_points(points).xyz,
        read_semidense_points(entries, semidense, params.point_deviation),
        make_rule(SceneRule, params, clearance=clearance),
        generator,
    )
    figures = found.figures
    job.progress.note(
        f"support plane with {figures['plane_share']:.0%} of the nearby upward-facing surface; object of "
        f"{figures['object_voxels']:.0f} voxels, {figures['supported_voxels']:.0f} of them with semi-dense points, "
        f"before {figures['rival_components']:.0f} other components"
    )
    if params.box_reach > 0:
        rule = make_params(SegmentParams, segmentation)
        images = _gather_images(entries, read_crops(crops), read_consistency(consistency), edges, depth, job)
        around = found.box.grow(params.box_reach * found.box.longest)
        grid, part = cut_grid(volume.grid, around)
        located = stand_on(grid, found.plane, known[part], clearance * grid.spacing)
        shown = np.zeros_like(known)
        shown[part] = find_extent(
            Scene(located, volume.sdf[part], around, **images, semidense={}),
            make_rule(
                GatherRule,
                rule,
                random_first=False,
                roi="box",
                surface_links=True,
                outer_margin=round(params.box_reach * found.box.longest / grid.spacing),
            ),
            make_rule(
                CutRule,
                rule,
                components=rule.color_components,
                iterations=_ROUNDS,
                first_carving="first_labels",
                color_pixels=_COLORS,
                sdf_weight=_FIELD_WEIGHT,
            ),
            generator,
            job.progress.note,
            job.threads,
        )
        found = widen_support(found, known, shown, volume.grid, params.box_margin)
        used, enlarged = found.figures["margin_used"], found.figures["box_enlarged"]
        job.progress.note(
            f"what images show of the object takes up {used:.0%} of the box's margin"
            + (f"; the box is enlarged to {enlarged:.2f} times its volume" if enlarged != 1 else "")
        )
    write_support(support, found, job.header)


def _gather_images(
    entries: Mapping[str, Keyframe],
    store: CropStore,
    trust: ConsistencyStore,
    edges: Sequence[Path],
    depth: Sequence[Path],
    job: Job,
) -> dict[str, dict[str, Any]]:
    """Return what the images show, by keyframe, as `Scene` takes it."""
    images = {name: store.image(name) for name in entries}
    valid = {name: store.valid_of(name) for name in entries}
    strength = {path.name.removesuffix(".zarr.zip"): read_edges(path) for path in edges}

    def split(name: str) -> Superpixels:
        return split_image(images[name], valid[name], strength[name], area=_SUPERPIXEL, compactness=_COMPACTNESS)

    return {
        "views": {name: entry.view for name, entry in entries.items()},
        "images": images,
        "valid": valid,
        "superpixels": dict(zip(entries, map_ahead(split, entries, threads=job.threads), strict=True)),
        "depth": {path.name.removesuffix(".zarr.zip"): read_depth_map(path).depth for path in depth},
        "confidence": {name: trust.read(name).confidence for name in entries},
    }
