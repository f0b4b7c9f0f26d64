"""Dense depth of one keyframe."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from threedfs.depth.candidates import space_candidates
from threedfs.depth.cost_volume import choose_patch_radius, compute_cost_volume
from threedfs.depth.measurements import merge_measurements
from threedfs.depth.solver import optimise_depth
from threedfs.depth.weights import edge_weight, measurement_weight, photometric_confidence, texture_confidence
from threedfs.depth.zncc import describe_patches, prepare_grey
from threedfs.io.depth_maps import DepthMap, read_edges, read_semidense, read_stereo, write_depth_map
from threedfs.io.frames import read_frames
from threedfs.io.keyframes import read_keyframe
from threedfs.job import Job
from threedfs.params.depth import DepthParams


def run(
    *,
    undistorted: Path,
    keyframes: Path,
    semidense: Path,
    edges: Path,
    stereo: Path | None,
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
    grey = prepare_grey(frames.image(keyframe), frames.valid)
    candidates = space_candidates(entry.near, entry.far, params.candidates, params.spacing)
    radius = params.patch_radius or choose_patch_radius(entry.neighbour_angle)
    job.progress.note(f"patches of {2 * radius + 1}x{2 * radius + 1} px")
    cost_volume = compute_cost_volume(
        entry.view,
        grey,
        entry.neighbours,
        lambda view: prepare_grey(frames.image(view.name), frames.valid),
        candidates,
        patch_radius=radius,
        variance_floor=params.variance_floor,
        missing_cost=params.missing_cost,
        track=lambda views: job.progress.track(views, "neighbour"),
    )
    min_cost = cost_volume.min(axis=0)
    patches = describe_patches(grey, radius, params.variance_floor)
    confidence = photometric_confidence(min_cost, params.confidence_falloff)
    confidence *= texture_confidence(patches.variance, params.texture_half_variance)
    confidence[~patches.complete] = 0
    inverse_depth, variance = measured.inverse_depth.astype(np.float64), measured.variance.astype(np.float64)
    if entry.neighbour_angle >= params.stereo_angle:
        matched = read_stereo(stereo).inverse_depth.astype(np.float64)
        inverse_depth, variance = merge_measurements(inverse_depth, variance, matched, params.stereo_deviation)
        confidence[np.isnan(matched)] *= params.unmatched_trust
    solution = optimise_depth(
        cost_volume,
        candidates,
        confidence,
        1 / inverse_depth,
        measurement_weight(variance, params.measurement_weight),
        edge_weight(read_edges(edges).astype(np.float64), params.edge_falloff),
        prior=params.prior,
        iterations=params.iterations,
        photometric_weight=params.photometric_weight,
        coupling=params.coupling,
        coupling_decay=params.coupling_decay,
        median_size=params.median_size,
        newton_rate=params.newton_rate,
        smoothness=params.smoothness,
        smoothness_growth=params.smoothness_growth,
        tolerance=params.tolerance,
        early_tolerance=params.early_tolerance,
        break_bending=params.break_bending,
        max_steps=params.max_steps,
        note=job.progress.note,
    )
    result = np.where(frames.valid & (solution.depth > 0), solution.depth, np.nan).astype(np.float32)
    write_depth_map(
        depth,
        DepthMap(result, min_cost, confidence.astype(np.float32)),
        job.header,
        solve_residuals=list(solution.residuals),
        solve_steps=list(solution.steps),
    )
