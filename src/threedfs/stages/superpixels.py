"""Split one keyframe into superpixels."""

from __future__ import annotations

from pathlib import Path

from threedfs.io.crops import read_crops
from threedfs.io.depth_maps import read_edges
from threedfs.io.keyframes import read_keyframe
from threedfs.io.superpixels import write_superpixels
from threedfs.job import Job
from threedfs.params.superpixels import SuperpixelsParams
from threedfs.segment.superpixels import split_image


def run(
    *,
    crops: Path,
    keyframes: Path,
    edges: Path,
    superpixels: Path,
    keyframe: str,
    params: SuperpixelsParams,
    job: Job,
) -> None:
    """Read one keyframe's image and contour strength; write its superpixels."""
    store = read_crops(crops)
    name = read_keyframe(keyframes, keyframe).view.name
    found = split_image(
        store.image(name), store.valid_of(name), read_edges(edges), area=params.area, compactness=params.compactness
    )
    write_superpixels(superpixels, found, job.header)
    job.progress.note(f"{keyframe}: {found.count} superpixels, {len(found.pairs)} pairs")
