"""Label the superpixels of all keyframes and the voxels of the object's grid."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from threedfs.io.appearance import write_appearance
from threedfs.io.consistency import read_consistency
from threedfs.io.crops import read_crops
from threedfs.io.depth_maps import read_depth_map
from threedfs.io.keyframes import read_keyframes
from threedfs.io.located import read_located
from threedfs.io.point_clouds import read_semidense_maps
from threedfs.io.segmentation import Segmentation, write_segmentation
from threedfs.io.superpixels import read_superpixels
from threedfs.io.volumes import read_support, read_volume
from threedfs.job import Job
from threedfs.params.rules import make_rule
from threedfs.params.segment import SegmentParams
from threedfs.read_ahead import map_ahead
from threedfs.segment.appearance import Appearance
from threedfs.segment.energy import OBJECT
from threedfs.segment.gather import (
    GatherRule,
    Scene,
    gather_images,
    gather_voxels,
    picture_support,
)
from threedfs.segment.joint import CutRule, segment_jointly
from threedfs.segment.outline import draw_voxels
from threedfs.segment.refine import RefineRule, refine_mask


def run(
    *,
    field: Path,
    located: Path,
    support: Path,
    keyframes: Path,
    crops: Path,
    superpixels: list[Path],
    semidense: list[Path],
    depth: list[Path],
    consistency: Path,
    labels: Path,
    appearance: Path,
    cut: str,
    params: SegmentParams,
    job: Job,
) -> None:
    """Read a field, the object in it and what the keyframes show; write labels, `joint` or of the `images` alone.

    What it has learnt of colours and of the support surface is written as well: it holds for frames between, too.
    """
    place, entries, store = read_located(located), read_keyframes(keyframes), read_crops(crops)
    views = {name: entry.view for name, entry in entries.items()}
    trust = read_consistency(consistency)
    scene = Scene(
        place,
        read_volume(field).sdf,
        read_support(support).box,
        views=views,
        images={name: store.image(name) for name in views},
        valid={name: store.valid_of(name) for name in views},
        superpixels={path.name.removesuffix(".zarr.zip"): read_superpixels(path) for path in superpixels},
        depth={path.name.removesuffix(".zarr.zip"): read_depth_map(path).depth for path in depth},
        confidence={name: trust.read(name).confidence for name in views},
        semidense=read_semidense_maps(semidense, params.point_deviation) if params.links == "semidense" else {},
    )
    gather = make_rule(
        GatherRule,
        params,
        random_first=params.first_labels == "random",
        surface_links=params.links == "surface",
    )
    job.progress.note(f"{cut}: the {params.field} field, {len(views)} keyframes")
    generator = np.random.default_rng(job.seed)
    volume, bounds = gather_voxels(scene, gather)
    table = picture_support(scene, bounds, gather, job.threads)
    images = gather_images(scene, volume, bounds, table, gather, generator, job.threads)
    rule = make_rule(CutRule, params, components=params.color_components)
    joint = volume if cut == "joint" else None
    found = segment_jointly(images, joint, rule, generator, job.progress.note, job.threads)
    masks = {name: images[name].superpixels.paint(own == OBJECT) for name, own in found.superpixels.items()}
    if params.refine:
        drawn = {} if found.voxels is None else draw_voxels(found.voxels == OBJECT, place.grid, views, job.threads)
        finer = make_rule(
            RefineRule,
            params,
            label_weight=params.refine_label_weight,
            pair_weight=params.refine_pair_weight,
            contrast=params.refine_contrast,
        )

        def refine(name):
            return refine_mask(images[name], found.superpixels[name], found.colors, drawn.get(name), finer)

        refined = map_ahead(refine, found.superpixels, threads=job.threads)
        masks = dict(zip(found.superpixels, job.progress.track(refined, "mask", len(views)), strict=True))
    voxels = np.zeros((0, 0, 0), np.uint8) if found.voxels is None else found.voxels
    write_segmentation(labels, Segmentation(masks, place.grid, voxels, found.energies, found.swaps), job.header)
    write_appearance(appearance, Appearance(found.colors, table), job.header)
