"""Dense depth of one keyframe."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from threedfs.depth.evidence import gather_evidence
from threedfs.depth.solver import optimise_depth
from threedfs.depth.weights import edge_weight, measurement_weight
from threedfs.io.depth_maps import DepthMap, read_edges, read_semidense, write_depth_map
from threedfs.io.frames import read_frames
from threedfs.io.keyframes import read_keyframe
from threedfs.job import Job
from threedfs.params.depth import DepthParams, matching_settings, solver_settings


def run(
    *,
    undistorted: Path,
    keyframes: Path,
    semidense: Path,
    edges: Path,
    depth: Path,
    keyframe: str,
    params: DepthParams,
    job: Job,
) -> None:
    """Read a keyframe with its neighbours, measurements and edges; write its depth map."""
    cv2.setNumThreads(1)  # a keyframe is one job of one core
    frames = read_frames(undistorted)
    entry = read_keyframe(keyframes, keyframe)
    measured = read_semidense(semidense)
    evidence = gather_evidence(
        entry,
        frames.image,
        frames.valid,
        **matching_settings(params),
        track=lambda views: job.progress.track(views, "neighbour"),
        note=job.progress.note,
    )
    solution = optimise_depth(
        evidence.cost_volume,
        evidence.candidates,
        evidence.confidence,
        1 / measured.inverse_depth.astype(np.float64),
        measurement_weight(measured.variance.astype(np.float64), params.measurement_weight),
        edge_weight(read_edges(edges).astype(np.float64), params.edge_falloff),
        **solver_settings(params),
        note=job.progress.note,
    )
    result = np.where(frames.valid & (solution.depth > 0), solution.depth, np.nan).astype(np.float32)
    write_depth_map(
        depth,
        DepthMap(result, evidence.min_cost, evidence.confidence.astype(np.float32)),
        job.header,
        solve_residuals=list(solution.residuals),
        solve_steps=list(solution.steps),
    )
