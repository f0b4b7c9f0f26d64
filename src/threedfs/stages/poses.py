"""Estimate the cameras of all working frames, or take given ones; triangulate sparse points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
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
from threedfs.params.rules import make_rule
from threedfs.poses.closures import ClosureRule
from threedfs.poses.continuity import measure_path
from threedfs.poses.gates import (
    check_agreement,
    check_continuity,
    check_points,
    check_quality,
    check_registered,
)
from threedfs.poses.given import GivenCamera, check_enough_given, find_cameras, fit_lens, shared_distortion
from threedfs.poses.matcher import FrameFeatures, MatchRule, PairMatcher
from threedfs.poses.normalise import find_scale, rescale_points
from threedfs.poses.pairs import overlapping_pairs
from threedfs.poses.path import PathRule, estimate_path
from threedfs.poses.quality import measure_points
from threedfs.poses.refinement import RefinementRule, refine_scene
from threedfs.poses.resection import ResectionRule, resect_frames
from threedfs.poses.scene import Scene, number_frames
from threedfs.poses.tracks import keep_well_seen
from threedfs.types import View


@dataclass(frozen=True)
class Film:
    """The frames, as (F, H, W) uint8 grey images too, and the numbers of those that keypoints were looked for in."""

    store: FrameStore
    images: np.ndarray
    described: Sequence[int]


@dataclass(frozen=True)
class Solved:
    """Cameras and points in the coordinates of the mapper or of the given cameras."""

    scene: Scene
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
    cv2.setNumThreads(1)  # threads are given whole frames
    store, found = read_frames(frames), read_features(features)
    rule = make_rule(MatchRule, params, max_angle=params.max_descriptor_angle, max_error=params.max_match_error)
    described = list(found.values())
    matcher = PairMatcher(FrameFeatures(described, store.shape, store.ordered), rule, job.seed, job.threads)
    images = np.stack([cv2.cvtColor(store.image(name), cv2.COLOR_RGB2GRAY) for name in store.names])
    film = Film(store, images, list(found))
    if cameras is not None:
        solved = _triangulate_given(film, matcher, read_given_cameras(cameras, intrinsics), params, job)
    else:
        solved = _estimate(film, matcher, calibration, params, job)
    keypoints = float(np.median([len(frame.pixels) for frame in described]))
    _write(store, solved.scene, {"features": keypoints, **solved.quality}, poses, points, job)


def _triangulate_given(
    film: Film, matcher: PairMatcher, given: Sequence[GivenCamera], params: PosesParams, job: Job
) -> Solved:
    store = film.store
    found = find_cameras(given, store.names, store.indices, numbered=store.ordered)
    check_enough_given(len(found), len(store.names))
    every_lens = {number: fit_lens(camera.lens, store.source_shape, store.shape) for number, camera in found.items()}
    every_pose = {number: camera.cam_from_world for number, camera in found.items()}
    ranks = {rank: number for rank, number in enumerate(film.described) if number in found}
    lenses = {rank: every_lens[number] for rank, number in ranks.items()}
    poses = {rank: every_pose[number] for rank, number in ranks.items()}
    pairs = overlapping_pairs(poses, max_angle=np.radians(params.pair_angle), most=params.pairs_per_frame)
    every = matcher.match(pairs)
    matches = matcher.agreeing(every, lenses, poses, min_matches=params.min_matches)
    agreement = check_agreement(sum(map(len, matches.values())), sum(map(len, every.values())), params.min_agreement)
    job.progress.note(f"{agreement:.0%} of the matches of {len(pairs)} pairs agree with the given cameras")
    model = triangulate(matcher.frames.features, matches, lenses, poses, seed=job.seed)
    scene = number_frames(model, lenses, matcher.frames.features, film.described)
    scene = replace(scene, lenses=every_lens, cam_from_world=every_pose)
    scene = _refine(film, scene, params, job, refine_poses=False, refine_lens=False)
    check_points(len(scene.points.xyz), params.least_points)
    quality = {"registered": len(every_pose), "agreement": agreement, **measure_points(scene.points, every_pose)}
    return Solved(scene, quality)


def _estimate(film: Film, matcher: PairMatcher, calibration: Path | None, params: PosesParams, job: Job) -> Solved:
    store, lens = film.store, None
    if calibration is not None:
        given = read_calibration(calibration)
        lens = fit_lens(Lens(given.camera, given.k1, given.k2), store.source_shape, store.shape)
    path = estimate_path(matcher, lens, _path_rule(params, _step_of(film.described)), job.progress.note)
    model = path.mapped.model
    job.progress.note(
        f"{len(model.cam_from_world)} of {len(film.described)} frames mapped, in parts of "
        f"{', '.join(map(str, path.mapped.parts))}"
    )
    lenses = dict.fromkeys(model.cam_from_world, path.mapped.lens)
    scene = number_frames(model, lenses, matcher.frames.features, film.described)
    if store.ordered:
        scene = _resect(film, scene, params, job)
    scene = _refine(film, scene, params, job, refine_poses=True, refine_lens=lens is None)
    poses, count = scene.cam_from_world, len(store.names)
    quality = {
        "registered": len(poses),
        "registered_share": check_registered(len(poses), count, params.min_registered),
        "largest_motion": path.motion,
        "flat_share": path.flat_share,
        "closures": path.closures,
        **measure_points(scene.points, poses),
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
    return Solved(scene, quality)


def _resect(film: Film, scene: Scene, params: PosesParams, job: Job) -> Scene:
    rule = make_rule(ResectionRule, params, max_error=params.max_match_error, min_inliers=params.second_try_inliers)
    added = resect_frames(scene, film.images, film.described, rule, seed=job.seed, threads=job.threads)
    left_out = len(film.images) - len(film.described)
    job.progress.note(f"{len(added)} of {left_out} frames in between posed")
    lens = next(iter(scene.lenses.values()))
    poses = dict(sorted({**scene.cam_from_world, **added}.items()))
    return replace(scene, lenses=dict.fromkeys(poses, lens), cam_from_world=poses)


def _refine(film: Film, scene: Scene, params: PosesParams, job: Job, *, refine_poses: bool, refine_lens: bool) -> Scene:
    """Follow patches through a video; photos look from too far apart for that. Drop points that are seen badly."""
    rule = make_rule(
        RefinementRule,
        params,
        patch_angle=np.radians(params.patch_angle),
        max_bend=np.radians(params.closure_rotation),
    )
    refined = scene
    if film.store.ordered:
        refined = refine_scene(
            scene, film.images, rule, refine_poses=refine_poses, refine_lens=refine_lens, threads=job.threads
        )
    points = keep_well_seen(
        refined.points,
        refined.cam_from_world,
        max_error=params.max_point_error,
        min_angle=np.radians(params.min_point_angle),
        min_track=params.min_point_track,
        min_points=params.min_points,
    )
    return replace(refined, points=points)


def _step_of(described: Sequence[int]) -> int:
    return described[1] - described[0] if len(described) > 1 else 1


def _path_rule(params: PosesParams, step: int) -> PathRule:
    closure = ClosureRule(
        max_angle=np.radians(params.closure_angle),
        min_gap=-(-params.closure_gap // step),
        min_overlap=params.closure_overlap,
        per_frame=params.closures_per_frame,
        max_rotation=np.radians(params.closure_rotation),
        max_direction=np.radians(params.closure_direction),
        min_cover=params.closure_cover,
    )
    return make_rule(
        PathRule,
        params,
        min_inliers=params.second_try_inliers,
        min_inlier_share=params.second_try_share,
        max_bend=np.radians(params.closure_rotation),
        closure=closure if params.closures else None,
    )


def _write(store: FrameStore, scene: Scene, quality: Mapping[str, float], poses: Path, points: Path, job: Job) -> None:
    numbers = sorted(scene.cam_from_world)
    scene_from_input = find_scale(scene.points, scene.cam_from_world)
    views = tuple(
        View(
            store.names[number],
            scene.lenses[number].camera,
            scene_from_input.apply_to_pose(scene.cam_from_world[number]),
        )
        for number in numbers
    )
    write_poses(
        poses,
        Poses(
            views=views,
            unposed=tuple(name for number, name in enumerate(store.names) if number not in scene.cam_from_world),
            distortion=shared_distortion([scene.lenses[number] for number in numbers]),
            scene_from_input=scene_from_input,
            quality={"frames": len(store.names), **quality},
        ),
        job.header,
    )
    write_points(points, rescale_points(scene.points, scene_from_input, numbers), job.header)
    job.progress.note(
        f"{len(numbers)} of {len(store.names)} frames with a pose, {quality['points']} points, "
        f"{quality['reprojection_error']:.2f} px, seen under {quality['triangulation_angle']:.1f} degrees"
    )
