"""Estimate the cameras of all working frames, or take given ones; triangulate sparse points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from threedfs.colmap.triangulation import triangulate
from threedfs.geometry.lens import Lens
from threedfs.io.calibration import read_calibration
from threedfs.io.features import read_features
from threedfs.io.frames import FrameStore, read_frames
from threedfs.io.given_cameras import read_given_cameras
from threedfs.io.points import write_points
from threedfs.io.poses import Poses, write_poses
from threedfs.job import Job
from threedfs.params.poses import PosesParams
from threedfs.poses.closures import ClosureRule
from threedfs.poses.continuity import measure_path
from threedfs.poses.gates import (
    check_agreement,
    check_continuity,
    check_points,
    check_quality,
    check_registered,
)
from threedfs.poses.given import GivenCamera, find_cameras, fit_lens, shared_distortion
from threedfs.poses.matcher import FrameFeatures, MatchRule, PairMatcher
from threedfs.poses.normalise import find_scale, rescale_points
from threedfs.poses.pairs import overlapping_pairs
from threedfs.poses.path import PathRule, estimate_path
from threedfs.poses.quality import measure_points
from threedfs.poses.tracks import keep_well_seen
from threedfs.types import SparsePoints, View


@dataclass(frozen=True)
class Solved:
    """Cameras and points in the coordinates of the mapper or of the given cameras."""

    lenses: Mapping[int, Lens]
    cam_from_world: Mapping[int, np.ndarray]
    points: SparsePoints
    quality: Mapping[str, float]


def run(
    *,
    frames: Path,
    features: Path,
    cameras: Path | None,
    calibration: Path | None,
    poses: Path,
    points: Path,
    intrinsics: Sequence[float] | None,
    params: PosesParams,
    job: Job,
) -> None:
    """Read frames, keypoints and, if given, cameras or a calibration; write poses.json and points.zarr.zip.

    Differs from the paper: structure from motion with loop closure in place of LSD-SLAM (3.1).

    Raises
    ------
    UserError
        If the frames give no reconstruction that can be trusted, or given cameras do not fit them.
    """
    store = read_frames(frames)
    found = read_features(features)
    rule = MatchRule(
        params.max_ratio, params.max_descriptor_angle, params.min_matches, params.max_match_error, params.focal_factor
    )
    matcher = PairMatcher(FrameFeatures(found, store.shape, store.ordered), rule, job.seed, job.threads)
    if cameras is not None:
        given = read_given_cameras(cameras, intrinsics)
        solved = _triangulate_given(store, matcher, given, params, job)
    else:
        solved = _estimate(store, matcher, calibration, params, job)
    _write(
        store,
        solved,
        {"features": float(np.median([len(frame.pixels) for frame in found])), **solved.quality},
        poses,
        points,
        job,
    )


def _triangulate_given(
    store: FrameStore, matcher: PairMatcher, given: Sequence[GivenCamera], params: PosesParams, job: Job
) -> Solved:
    found = find_cameras(given, store.names, store.indices, numbered=store.ordered)
    lenses = {number: fit_lens(camera.lens, store.source_shape, store.shape) for number, camera in found.items()}
    poses = {number: camera.cam_from_world for number, camera in found.items()}
    pairs = overlapping_pairs(poses, max_angle=np.radians(params.pair_angle), most=params.pairs_per_frame)
    every = matcher.match(pairs)
    matches = matcher.agreeing(every, lenses, poses, min_matches=params.min_matches)
    agreement = check_agreement(sum(map(len, matches.values())), sum(map(len, every.values())), params.min_agreement)
    job.progress.note(f"{agreement:.0%} of the matches of {len(pairs)} pairs agree with the given cameras")
    model = triangulate(matcher.frames.features, matches, lenses, poses, seed=job.seed)
    points = _good_points(model.points, poses, params)
    quality = {"registered": len(poses), "agreement": agreement, **measure_points(points, poses)}
    check_points(len(points.xyz), params.least_points)
    return Solved(lenses, poses, points, quality)


def _estimate(
    store: FrameStore, matcher: PairMatcher, calibration: Path | None, params: PosesParams, job: Job
) -> Solved:
    lens = None
    if calibration is not None:
        given = read_calibration(calibration)
        lens = fit_lens(Lens(given.camera, given.k1, given.k2), store.source_shape, store.shape)
    count = len(store.names)
    path = estimate_path(matcher, lens, _path_rule(params), job.progress.note)
    poses = path.mapped.model.cam_from_world
    job.progress.note(f"{len(poses)} of {count} frames posed, in parts of {', '.join(map(str, path.mapped.parts))}")
    points = _good_points(path.mapped.model.points, poses, params)
    quality = {
        "registered": len(poses),
        "registered_share": check_registered(len(poses), count, params.min_registered),
        "largest_motion": path.motion,
        "flat_share": path.flat_share,
        "closures": path.closures,
        **measure_points(points, poses),
    }
    check_quality(
        quality,
        max_error=params.max_reprojection_error,
        min_track_length=params.min_track_length,
        min_angle=params.min_triangulation_angle,
    )
    if store.ordered:
        quality |= measure_path(store.times, poses, params.step_spacing)
        check_continuity(quality["step_ratio"], params.max_step_ratio)
    return Solved(dict.fromkeys(poses, path.mapped.lens), poses, points, quality)


def _path_rule(params: PosesParams) -> PathRule:
    closure = ClosureRule(
        max_angle=np.radians(params.closure_angle),
        min_gap=params.closure_gap,
        min_overlap=params.closure_overlap,
        per_frame=params.closures_per_frame,
        max_rotation=np.radians(params.closure_rotation),
        max_direction=np.radians(params.closure_direction),
        min_cover=params.closure_cover,
    )
    return PathRule(
        overlap=params.overlap,
        gap_overlap=params.gap_overlap,
        min_motion=params.min_motion,
        max_flat_share=params.max_flat_share,
        min_inliers=params.second_try_inliers,
        min_inlier_share=params.second_try_share,
        max_bend=np.radians(params.closure_rotation),
        min_agreement=params.min_agreement,
        closure=closure if params.closures else None,
    )


def _good_points(points: SparsePoints, poses: Mapping[int, np.ndarray], params: PosesParams) -> SparsePoints:
    return keep_well_seen(
        points,
        poses,
        max_error=params.max_point_error,
        min_angle=np.radians(params.min_point_angle),
        min_track=params.min_point_track,
        min_points=params.min_points,
    )


def _write(
    store: FrameStore, solved: Solved, quality: Mapping[str, float], poses: Path, points: Path, job: Job
) -> None:
    numbers = sorted(solved.cam_from_world)
    scene_from_input = find_scale(solved.points, solved.cam_from_world)
    views = tuple(
        View(
            store.names[number],
            solved.lenses[number].camera,
            scene_from_input.apply_to_pose(solved.cam_from_world[number]),
        )
        for number in numbers
    )
    write_poses(
        poses,
        Poses(
            views=views,
            unposed=tuple(name for number, name in enumerate(store.names) if number not in solved.cam_from_world),
            distortion=shared_distortion([solved.lenses[number] for number in numbers]),
            scene_from_input=scene_from_input,
            quality={"frames": len(store.names), **quality},
        ),
        job.header,
    )
    write_points(points, rescale_points(solved.points, scene_from_input, numbers), job.header)
    job.progress.note(
        f"{len(numbers)} of {len(store.names)} frames with a pose, {quality['points']} points, "
        f"{quality['reprojection_error']:.2f} px, seen under {quality['triangulation_angle']:.1f} degrees"
    )
