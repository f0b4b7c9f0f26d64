"""One keyframe of the depth experiment: its depth by every prior and by interpolation, from drawn measurements."""

from __future__ import annotations

import zlib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from threedfs.depth.bending import PRIORS
from threedfs.depth.evidence import gather_evidence
from threedfs.depth.solver import optimise_depth
from threedfs.depth.weights import edge_weight, measurement_weight
from threedfs.evaluate.depth_experiment import draw_measurements
from threedfs.evaluate.interpolation import interpolate_depth
from threedfs.evaluate.masks import check_mask_size
from threedfs.evaluate.rendering import MeshRenderer, filmed_pixels, image_points, sample_nearest
from threedfs.evaluate.true_cameras import Filmed, relate_cameras
from threedfs.frames.masks import match_masks
from threedfs.io.crops import read_crops
from threedfs.io.depth_maps import read_edges
from threedfs.io.depth_trials import DepthTrial, write_depth_trial
from threedfs.io.frames import FrameStore, read_frames
from threedfs.io.given_cameras import read_given_cameras
from threedfs.io.images import read_mask
from threedfs.io.keyframes import read_keyframe
from threedfs.io.meshes import read_mesh
from threedfs.io.poses import read_poses
from threedfs.io.truth import read_true_depth
from threedfs.io.truth_files import find_depth_images
from threedfs.job import Job
from threedfs.params.depth import DepthParams, matching_settings, solver_settings
from threedfs.params.depth_trial import DepthTrialParams
from threedfs.params.schema import make_params


def run(
    *,
    frames: Path,
    crops: Path,
    keyframes: Path,
    edges: Path,
    poses: Path,
    masks_truth: Path | None,
    cameras_truth: Path,
    mesh_truth: Path | None,
    depth_truth: Path,
    trial: Path,
    keyframe: str,
    depth_settings: Mapping[str, Any],
    depth_scale: float,
    depth_camera: Mapping[str, Sequence[float]] | None,
    intrinsics: Sequence[float] | None,
    params: DepthTrialParams,
    job: Job,
) -> None:
    """Read a keyframe with its neighbours and its truth; write its depth maps by all methods.

    Raises
    ------
    UserError
        If a truth cannot be read, does not belong to the keyframe, or has too few depths.
    """
    cv2.setNumThreads(1)  # a keyframe is one job of one core
    store, images, solved = read_frames(frames), read_crops(crops), read_poses(poses)
    entry = read_keyframe(keyframes, keyframe)
    dense = make_params(DepthParams, depth_settings)
    true_cameras = relate_cameras(read_given_cameras(cameras_truth, intrinsics), solved.views, store)
    whole = next(view.camera for view in solved.views if view.name == keyframe)
    scale = true_cameras.from_scene.scale
    pixels = filmed_pixels(entry.view.camera, whole, solved.distortion, store.source_shape)
    filmed = true_cameras.seen.get(keyframe)
    colour = None if filmed is None else filmed[0].camera
    file = find_depth_images(depth_truth, [keyframe])[keyframe]
    image = read_true_depth(file, depth_scale, store.source_shape, depth_camera, colour)
    truth = np.where(images.valid_of(keyframe), sample_nearest(image, pixels, np.nan), np.nan)
    drawn = draw_measurements(
        truth, max(params.measurements), np.random.default_rng([job.seed, zlib.crc32(keyframe.encode())])
    )
    evidence = gather_evidence(
        entry,
        images.image,
        images.valid_of,
        **matching_settings(dense),
        track=lambda views: job.progress.track(views, "neighbour"),
        note=job.progress.note,
    )
    smoothing = edge_weight(read_edges(edges).astype(np.float64), dense.edge_falloff)
    maps = {}
    for count in params.measurements:
        known = tuple(drawn[:count].T)
        maps[f"interpolation/{count}"] = interpolate_depth(drawn[:count], truth[known], truth.shape)
        variance = np.full(truth.shape, np.nan)
        variance[known] = params.measurement_deviation**2
        for prior in PRIORS:
            solution = optimise_depth(
                evidence.cost_volume,
                evidence.candidates,
                evidence.confidence,
                truth / scale,
                measurement_weight(variance, dense.measurement_weight),
                smoothing,
                **solver_settings(replace(dense, prior=prior)),
            )
            maps[f"{prior}/{count}"] = scale * solution.depth
            job.progress.note(f"{prior} from {count} measurements: {sum(solution.steps)} steps")
    on_object = _find_object(masks_truth, mesh_truth, keyframe, filmed, pixels, store)
    depth = np.stack(list(maps.values())).astype(np.float32)
    write_depth_trial(trial, DepthTrial(tuple(maps), depth, truth.astype(np.float32), on_object, drawn), job.header)


def _find_object(
    masks: Path | None,
    mesh: Path | None,
    keyframe: str,
    filmed: Filmed | None,
    pixels: np.ndarray,
    frames: FrameStore,
) -> np.ndarray:
    """Find the object's pixels: by the keyframe's mask, or the true mesh; none without either."""
    files = {} if masks is None else {file.stem: file for file in sorted(masks.glob("*.png"))}
    stem = match_masks(files, [keyframe], numbered=frames.ordered).get(keyframe)
    if stem is not None:
        mask = read_mask(files[stem])
        check_mask_size(mask, frames.source_shape, str(files[stem]))
        return sample_nearest(mask, pixels, False)
    if mesh is not None and filmed is not None:
        view, distortion = filmed
        points = image_points(view.camera, distortion, pixels)
        return np.isfinite(MeshRenderer(read_mesh(mesh)).depth(view.cam_from_world, points))
    return np.zeros(pixels.shape[:2], bool)
