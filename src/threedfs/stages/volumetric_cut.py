"""Label voxels by colours and photo-consistency alone: the baseline volumetric_gc."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from threedfs.geometry.grid import cover_box, voxel_index
from threedfs.io.crops import read_crops
from threedfs.io.keyframes import read_keyframes
from threedfs.io.point_clouds import read_semidense_points
from threedfs.io.segmentation import Segmentation, write_segmentation
from threedfs.io.volumes import read_support
from threedfs.job import Job
from threedfs.locate.fixation import find_fixation
from threedfs.locate.height import height_above
from threedfs.params.rules import make_rule
from threedfs.params.volumetric_cut import VolumetricCutParams
from threedfs.segment.volumetric import VolumetricRule, cut_volume


def run(
    *,
    support: Path,
    keyframes: Path,
    crops: Path,
    semidense: list[Path],
    labels: Path,
    params: VolumetricCutParams,
    job: Job,
) -> None:
    """Read images, the object's box and semi-dense points; write voxel labels."""
    place, entries, store = read_support(support), read_keyframes(keyframes), read_crops(crops)
    views = {name: entry.view for name, entry in entries.items()}
    grid = cover_box(place.box, params.longest_side)
    votes = np.zeros(grid.shape, np.float32)
    for cloud in read_semidense_points(entries, semidense, params.point_deviation):
        index, _ = voxel_index(grid, cloud)
        np.add.at(votes, tuple(index.T), 1)
    voxels = cut_volume(
        {name: store.image(name) for name in views},
        views,
        grid,
        height_above(place.plane, grid),
        votes,
        find_fixation(list(views.values()), place.box.centre),
        make_rule(VolumetricRule, params),
        np.random.default_rng(job.seed),
        job.progress.note,
    )
    write_segmentation(labels, Segmentation({}, grid, voxels, np.zeros(0), np.zeros(0, np.int64)), job.header)
