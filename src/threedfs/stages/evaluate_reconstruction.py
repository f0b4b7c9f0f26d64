"""Score what all methods share, poses and depth maps, against ground truth, where there is any."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from threedfs.evaluate.depth_error import DepthPairs, pair_depths
from threedfs.evaluate.figures import Figure, depth_figures, pose_figures, reconstruction_figures
from threedfs.evaluate.pose_error import measure_poses
from threedfs.evaluate.rendering import MeshRenderer, filmed_pixels, image_points, sample_nearest
from threedfs.evaluate.scores import Metric
from threedfs.evaluate.true_cameras import TrueCameras, relate_cameras
from threedfs.io.depth_maps import read_depth_map
from threedfs.io.frames import FrameStore, read_frames
from threedfs.io.given_cameras import read_given_cameras
from threedfs.io.given_meshes import read_given_mesh
from threedfs.io.keyframes import read_keyframes
from threedfs.io.metrics import write_metrics
from threedfs.io.poses import Poses, read_poses
from threedfs.io.truth import read_true_depth
from threedfs.io.truth_files import match_depth_images
from threedfs.job import Job
from threedfs.params.evaluate_reconstruction import EvaluateReconstructionParams
from threedfs.types import Keyframe, Mesh


def run(
    *,
    poses: Path,
    keyframes: Path,
    depth: list[Path],
    frames: Path,
    cameras_truth: Path | None,
    mesh_truth: Path | None,
    depth_truth: Path | None,
    metrics: Path,
    dataset: str,
    sequence: str,
    intrinsics: Sequence[float] | None,
    depth_scale: float,
    depth_camera: Mapping[str, Sequence[float]] | None,
    params: EvaluateReconstructionParams,
    job: Job,
) -> None:
    """Measure what there is a truth for; write a table of metrics without a method.

    Raises
    ------
    UserError
        If a truth cannot be read, does not belong to the frames, or lacks the cameras that it is aligned by.
    """
    store, solved, selected = read_frames(frames), read_poses(poses), read_keyframes(keyframes)
    maps = {path.name.removesuffix(".zarr.zip"): path for path in depth}
    figures = reconstruction_figures(len(solved.views), len(solved.unposed), solved.quality)
    if cameras_truth is not None:
        truth = relate_cameras(read_given_cameras(cameras_truth, intrinsics), solved.views, store)
        figures += _score_poses(truth, solved)
        if mesh_truth is not None:
            figures += _score_depth_by_mesh(read_given_mesh(mesh_truth), maps, truth, selected, solved, params)
        if depth_truth is not None:
            images = match_depth_images(depth_truth, selected)
            if images:
                figures += _score_depth_by_images(
                    images, depth_scale, depth_camera, maps, truth, selected, solved, store
                )
            else:
                job.progress.note(f"no keyframe has a true depth in {depth_truth}: none is scored")
    write_metrics(
        metrics,
        [Metric(item.name, item.value, item.unit, dataset, sequence, keyframe=item.keyframe) for item in figures],
    )
    job.progress.note(f"{len(figures)} figures of {len(solved.views)} posed frames and {len(selected)} keyframes")


def _score_poses(truth: TrueCameras, solved: Poses) -> list[Figure]:
    common = [view for view in solved.views if view.name in truth.seen]
    exact = [truth.seen[view.name][0].cam_from_world for view in common]
    error = measure_poses([view.cam_from_world for view in common], exact, truth.from_scene)
    return pose_figures([view.name for view in common], error)


def _score_depth_by_mesh(
    exact: Mesh,
    maps: Mapping[str, Path],
    truth: TrueCameras,
    selected: Mapping[str, Keyframe],
    solved: Poses,
    params: EvaluateReconstructionParams,
) -> list[Figure]:
    renderer, whole = MeshRenderer(exact), {view.name: view.camera for view in solved.views}
    pairs = {}
    for name in (name for name in selected if name in truth.seen):
        filmed, distortion = truth.seen[name]
        pixels = filmed_pixels(selected[name].view.camera, whole[name], solved.distortion, filmed.camera.shape)
        expected = renderer.depth(filmed.cam_from_world, image_points(filmed.camera, distortion, pixels))
        estimated = truth.from_scene.scale * read_depth_map(maps[name]).depth
        pairs[name] = pair_depths(estimated, expected, erosion=params.silhouette_erosion)
    return depth_figures(pairs, "truth unit")


def _score_depth_by_images(
    images: Mapping[str, Path],
    scale: float,
    depth_camera: Mapping[str, Sequence[float]] | None,
    maps: Mapping[str, Path],
    truth: TrueCameras,
    selected: Mapping[str, Keyframe],
    solved: Poses,
    store: FrameStore,
) -> list[Figure]:
    pairs: dict[str, DepthPairs] = {}
    whole = {view.name: view.camera for view in solved.views}
    for name, file in images.items():
        colour = truth.seen[name][0].camera if name in truth.seen else None
        image = read_true_depth(file, scale, store.source_shape, depth_camera, colour)
        pixels = filmed_pixels(selected[name].view.camera, whole[name], solved.distortion, store.source_shape)
        estimated = truth.from_scene.scale * read_depth_map(maps[name]).depth
        pairs[name] = pair_depths(estimated, sample_nearest(image, pixels, np.nan))
    return depth_figures(pairs, "truth unit", "scene_depth")
