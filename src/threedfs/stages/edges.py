"""Measure the contour strength of one keyframe."""

from __future__ import annotations

from pathlib import Path

from threedfs.edges.multiscale import multiscale_gradient
from threedfs.io.crops import read_crops
from threedfs.io.depth_maps import write_edges
from threedfs.io.keyframes import read_keyframe
from threedfs.job import Job
from threedfs.params.edges import EdgesParams

_METHODS = {"multiscale_gradient": multiscale_gradient}


def run(*, crops: Path, keyframes: Path, edges: Path, keyframe: str, params: EdgesParams, job: Job) -> None:
    """Read one keyframe's image; write its contour strength."""
    store = read_crops(crops)
    name = read_keyframe(keyframes, keyframe).view.name
    valid = store.valid_of(name)
    strength = _METHODS[params.method](
        store.image(name),
        valid,
        params.scales,
        params.full_strength_percentile,
        params.min_full_strength,
    )
    write_edges(edges, strength, job.header)
    job.progress.note(f"{keyframe}: mean contour strength {float(strength[valid].mean()):.3f}")
