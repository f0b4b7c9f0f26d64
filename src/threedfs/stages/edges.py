"""Measure the contour strength of one keyframe."""

from __future__ import annotations

from pathlib import Path

import cv2

from threedfs.edges.multiscale import multiscale_gradient
from threedfs.edges.structured import structured_contours
from threedfs.io.contour_forest import read_forest
from threedfs.io.crops import read_crops
from threedfs.io.depth_maps import write_edges
from threedfs.io.keyframes import read_keyframe
from threedfs.job import Job
from threedfs.params.edges import EdgesParams


def run(*, crops: Path, keyframes: Path, edges: Path, keyframe: str, params: EdgesParams, job: Job) -> None:
    """Read one keyframe's image; write its contour strength."""
    store = read_crops(crops)
    name = read_keyframe(keyframes, keyframe).view.name
    image, valid = store.image(name), store.valid_of(name)
    if params.method == "structured":
        cv2.setNumThreads(1)  # a keyframe is one job of one core
        strength = structured_contours(image, valid, read_forest())
    else:
        strength = multiscale_gradient(
            image, valid, params.scales, params.full_strength_percentile, params.min_full_strength
        )
    write_edges(edges, strength, job.header)
    job.progress.note(f"{keyframe}: mean contour strength {float(strength[valid].mean()):.3f}")
