"""Estimate the cameras of all working frames, or take given ones; triangulate sparse points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from threedfs.colmap.features import Features, extract_features
from threedfs.colmap.mapping import Mapped, map_frames
from threedfs.colmap.triangulation import triangulate
from threedfs.colmap.verification import Verified, verify_matches
from threedfs.geometry.lens import Lens
from threedfs.io.calibration import read_calibration
from threedfs.io.frames import FrameStore, read_frames
from threedfs.io.given_cameras import read_given_cameras
from threedfs.io.points import write_points
from threedfs.io.poses import Poses, write_poses
from threedfs.job import Job
from threedfs.params.poses import PosesParams
from threedfs.poses.closures import accept_closures, closure_candidates, predict_overlap, stays_on_path
from threedfs.poses.continuity import step_ratio, turns_around
from threedfs.poses.epipolar import agreeing_matches
from threedfs.poses.gates import (
    check_agreement,
    check_continuity,
    check_features,
    check_mapped,
    check_motion,
    check_parallax,
    check_points,
    check_quality,
    check_registered,
)
from threedfs.poses.given import find_cameras, fit_lens, shared_distortion
from threedfs.poses.matching import match_pairs
from threedfs.poses.normalise import find_scale, rescale_points
from threedfs.poses.pairs import Pairs, exhaustive_pairs, overlapping_pairs, sequential_pairs
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
    cameras: Path | None,
    calibration: Path | None,
    poses: Path,
    points: Path,
    params: PosesParams,
    job: Job,
) -> None:
    """Read the frames and, if given, cameras or a calibration; write poses.json and points.zarr.zip.

    Raises
    ------
    UserError
        If the frames give no reconstruction that can be trusted, or given cameras do not fit them.
    """
    store = read_frames(frames)
    features = extract_features(
        (store.image(name) for name in job.progress.track(store.names, "frames read")),
        max_features=params.max_features,
        min_contrast=params.min_contrast,
        threads=job.threads,
    )
    median_features = check_features(features, params.min_features)
    job.progress.note(f"median of {median_features:.0f} keypoints a frame")
    if cameras is not None:
        solved = _triangulate_given(store, features, cameras, params, job)
    else:
        solved = _estimate(store, features, calibration, params, job)
    _write(store, solved, {"features": median_features, **solved.quality}, poses, points, job)


def _triangulate_given(
    store: FrameStore, features: Sequence[Features], cameras: Path, params: PosesParams, job: Job
) -> Solved:
    found = find_cameras(read_given_cameras(cameras), store.names, store.indices, numbered=store.ordered)
    lenses = {number: fit_lens(camera.lens, store.source_shape, store.shape) for number, camera in found.items()}
    poses = {number: camera.cam_from_world for number, camera in found.items()}
    pairs = overlapping_pairs(poses, max_angle=np.radians(params.pair_angle), most=params.pairs_per_frame)
    every = _match(features, pairs, params, job)
    matches = agreeing_matches(
        [frame.pixels for frame in features],
        every,
        lenses,
        poses,
        max_error=params.max_match_error,
        min_matches=params.min_matches,
    )
    agreement = check_agreement(sum(map(len, matches.values())), sum(map(len, every.values())), params.min_agreement)
    job.progress.note(f"{agreement:.0%} of the matches of {len(pairs)} pairs agree with the given cameras")
    model = triangulate(features, matches, lenses, poses, seed=job.seed)
    points = _good_points(model.points, poses, params)
    quality = {"registered": len(poses), "agreement": agreement, **measure_points(points, poses)}
    check_points(len(points.xyz), params.least_points)
    return Solved(lenses, poses, points, quality)


def _estimate(
    store: FrameStore, features: Sequence[Features], calibration: Path | None, params: PosesParams, job: Job
) -> Solved:
    lens = None
    if calibration is not None:
        given = read_calibration(calibration)
        lens = fit_lens(Lens(given.camera, given.k1, given.k2), store.source_shape, store.shape)
    count = len(features)
    pairs = sequential_pairs(count, params.overlap) if store.ordered else exhaustive_pairs(count)
    verified = _verify(store, features, pairs, lens, params, job)
    motion = check_motion(features, verified, params.min_motion)
    flat_share = check_parallax(verified, params.max_flat_share)
    job.progress.note(f"{len(verified)} of {len(pairs)} pairs of frames verified, {flat_share:.0%} without parallax")
    mapped = check_mapped(_map(store, features, verified, lens, params, job), len(verified))
    if store.ordered and len(mapped.model.cam_from_world) < count:
        job.progress.note("some frames have no pose: matching over gaps")
        wider = sorted(set(sequential_pairs(count, params.gap_overlap)) - set(pairs))
        bridges = _verify(store, features, wider, lens, params, job)
        mapped = _extend(store, features, mapped, verified, bridges, lens, params, job)
        verified = verified | bridges
    closures = {}
    if store.ordered and params.closures:
        closures = _find_closures(store, features, mapped, params, job)
        if closures:
            mapped = _extend(store, features, mapped, verified, closures, lens, params, job)
    poses = mapped.model.cam_from_world
    job.progress.note(f"{len(poses)} of {count} frames posed, in parts of {', '.join(map(str, mapped.parts))}")
    points = _good_points(mapped.model.points, poses, params)
    quality = {
        "registered": len(poses),
        "registered_share": check_registered(len(poses), count, params.min_registered),
        "largest_motion": motion,
        "flat_share": flat_share,
        "closures": len(closures),
        **measure_points(points, poses),
    }
    check_quality(
        quality,
        max_error=params.max_reprojection_error,
        min_track_length=params.min_track_length,
        min_angle=params.min_triangulation_angle,
    )
    if store.ordered:
        quality |= _measure_path(store, poses, params)
        check_continuity(quality["step_ratio"], params.max_step_ratio)
    return Solved(dict.fromkeys(poses, mapped.lens), poses, points, quality)


def _find_closures(
    store: FrameStore, features: Sequence[Features], mapped: Mapped, params: PosesParams, job: Job
) -> dict[tuple[int, int], Verified]:
    poses = mapped.model.cam_from_world
    frames, overlap = predict_overlap(
        mapped.model.points, mapped.lens, poses, max_angle=np.radians(params.closure_angle)
    )
    candidates = closure_candidates(
        frames,
        overlap,
        min_gap=params.closure_gap,
        min_overlap=params.closure_overlap,
        per_frame=params.closures_per_frame,
    )
    verified = _verify(store, features, candidates, mapped.lens, params, job)
    closures = accept_closures(
        [frame.pixels for frame in features],
        verified,
        poses,
        store.shape,
        max_rotation=np.radians(params.closure_rotation),
        max_direction=np.radians(params.closure_direction),
        min_cover=params.closure_cover,
    )
    job.progress.note(f"{len(closures)} of {len(candidates)} candidates for loop closure agree with the path")
    return closures


def _extend(
    store: FrameStore,
    features: Sequence[Features],
    first: Mapped,
    verified: Mapping[tuple[int, int], Verified],
    added: Mapping[tuple[int, int], Verified],
    lens: Lens | None,
    params: PosesParams,
    job: Job,
) -> Mapped:
    everything = {**verified, **added}
    extended = _map(store, features, everything, lens, params, job, start=first)
    if extended is not None and not _follows(features, added, extended, params):
        job.progress.note("the path has drifted too far to be closed by adjustment: mapping again with all pairs")
        extended = _map(store, features, everything, lens, params, job)
    tolerance = np.radians(params.closure_rotation)
    if extended is None or not stays_on_path(first.model.cam_from_world, extended.model.cam_from_world, tolerance):
        job.progress.note("with more pairs of frames the path bends: the first path is kept")
        return first
    return extended


def _follows(
    features: Sequence[Features], added: Mapping[tuple[int, int], Verified], mapped: Mapped, params: PosesParams
) -> bool:
    poses = mapped.model.cam_from_world
    posed = {pair: found.matches for pair, found in added.items() if pair[0] in poses and pair[1] in poses}
    agreeing = agreeing_matches(
        [frame.pixels for frame in features],
        posed,
        dict.fromkeys(poses, mapped.lens),
        poses,
        max_error=params.max_match_error,
        min_matches=1,
    )
    return sum(map(len, agreeing.values())) >= params.min_agreement * sum(map(len, posed.values()))


def _verify(
    store: FrameStore, features: Sequence[Features], pairs: Pairs, lens: Lens | None, params: PosesParams, job: Job
) -> dict[tuple[int, int], Verified]:
    return verify_matches(
        features,
        _match(features, pairs, params, job),
        width=store.shape[1],
        height=store.shape[0],
        lens=lens,
        focal_factor=params.focal_factor,
        max_error=params.max_match_error,
        seed=job.seed,
        threads=job.threads,
    )


def _map(
    store: FrameStore,
    features: Sequence[Features],
    verified: Mapping[tuple[int, int], Verified],
    lens: Lens | None,
    params: PosesParams,
    job: Job,
    start: Mapped | None = None,
) -> Mapped | None:
    return map_frames(
        features,
        {pair: found.matches for pair, found in verified.items()},
        width=store.shape[1],
        height=store.shape[0],
        lens=lens,
        focal_factor=params.focal_factor,
        min_inliers=params.second_try_inliers,
        min_inlier_share=params.second_try_share,
        seed=job.seed,
        start=start,
    )


def _match(features: Sequence[Features], pairs: Pairs, params: PosesParams, job: Job) -> dict:
    return match_pairs(
        [frame.descriptors for frame in features],
        pairs,
        max_ratio=params.max_ratio,
        max_angle=params.max_descriptor_angle,
        min_matches=params.min_matches,
        threads=job.threads,
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


def _measure_path(store: FrameStore, poses: Mapping[int, np.ndarray], params: PosesParams) -> dict[str, float]:
    numbers = sorted(poses)
    path = np.array([poses[number] for number in numbers])
    return {
        "step_ratio": step_ratio(store.times[numbers], path, params.step_spacing),
        "turns": turns_around(path),
    }


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
