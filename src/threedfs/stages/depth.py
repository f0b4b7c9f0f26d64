"""Dense depth of one keyframe."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from threedfs.depth.evidence import gather_evidence
from threedfs.depth.measurements import distrust_unmatched, merge_measurements
from threedfs.depth.solver import optimise_depth
from threedfs.depth.weights import edge_weight, measurement_weight
from threedfs.io.crops import read_crops
from threedfs.io.depth_maps import DepthMap, read_edges, read_semidense, read_stereo, write_depth_map
from threedfs.io.keyframes import read_keyframe, read_object_pixels
from threedfs.job import Job
from threedfs.params.depth import DepthParams, matching_settings, solver_settings


def run(
    *,
    crops: Path,
    keyframes: Path,
    semidense: Path,
    edges: Path,
    stereo: Path | None,
    depth: Path,
    keyframe: str,
    params: DepthParams,
    job: Job,
) -> None:
    """Read a keyframe with its neighbours, measurements and edges; write its depth map.

    Differs from the paper: where views are far apart, stereo matches are measurements too (`keyframes.stereo_angle`),
    and depth in front of the keyframe's range is left out.
    """
    cv2.setNumThreads(1)  # a keyframe is one job of one core
    frames = read_crops(crops)
    entry = read_keyframe(keyframes, keyframe)
    measured = read_semidense(semidense)
    evidence = gather_evidence(
        entry,
        frames.image,
        frames.valid_of,
        **matching_settings(params),
        track=lambda views: job.progress.track(views, "neighbour"),
        note=job.progress.note,
    )
    confidence = evidence.confidence
    inverse_depth, variance = measured.inverse_depth.astype(np.float64), measured.variance.astype(np.float64)
    if stereo is not None:
        matched = read_stereo(stereo).inverse_depth.astype(np.float64)
        inverse_depth, variance = merge_measurements(inverse_depth, variance, matched, params.stereo_deviation)
        confidence = distrust_unmatched(confidence, matched, params.unmatched_trust)
    length = read_object_pixels(keyframes, keyframe) or 0.0
    solution = optimise_depth(
        evidence.cost_volume,
        evidence.candidates,
        confidence,
        1 / inverse_depth,
        measurement_weight(variance, params.measurement_weight),
        edge_weight(read_edges(edges).astype(np.float64), params.edge_falloff),
        magnification=max(1.0, length / params.object_pixels),
        **solver_settings(params),
        note=job.progress.note,
    )
    # Where nothing holds it, the smooth surface may swing far out; in front of the scene it would hide all else.
    result = np.where(frames.valid_of(keyframe) & (solution.depth >= entry.near), solution.depth, np.nan).astype(
        np.float32
    )
    write_depth_map(
        depth,
        DepthMap(result, evidence.min_cost, confidence.astype(np.float32)),
        job.header,
        solve_residuals=list(solution.residuals),
        solve_steps=list(solution.steps),
    )
