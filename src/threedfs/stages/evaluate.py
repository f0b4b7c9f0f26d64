"""Score poses, depth, mesh and masks against ground truth, where there is any."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from threedfs.errors import UserError
from threedfs.evaluate.cylinder import measure_cylinder
from threedfs.evaluate.depth_error import DepthPairs, pair_depths
from threedfs.evaluate.figures import (
    Figure,
    cylinder_figures,
    depth_figures,
    mask_figures,
    mesh_figures,
    pose_figures,
    reconstruction_figures,
    soundness_figures,
)
from threedfs.evaluate.masks import check_mask_size, intersection_over_union
from threedfs.evaluate.mesh_error import measure_mesh
from threedfs.evaluate.pose_error import align_poses, measure_poses
from threedfs.evaluate.rendering import MeshRenderer, filmed_pixels, image_points, sample_nearest
from threedfs.frames.masks import find_masks
from threedfs.frames.picture import name_video_frame
from threedfs.geometry.similarity import Similarity
from threedfs.io.depth_maps import read_depth_map
from threedfs.io.frames import FrameStore, read_frames
from threedfs.io.given_cameras import GivenCamera, read_given_cameras
from threedfs.io.images import read_mask
from threedfs.io.keyframes import read_keyframes
from threedfs.io.meshes import read_mesh
from threedfs.io.metrics import Metric, write_metrics
from threedfs.io.poses import Poses, read_poses
from threedfs.io.truth import read_true_depth
from threedfs.io.truth_files import find_depth_images
from threedfs.job import Job
from threedfs.object.silhouettes import draw_source_silhouette
from threedfs.params.evaluate import EvaluateParams
from threedfs.poses.given import find_cameras, state_size
from threedfs.types import Keyframe, Mesh, View

Filmed = tuple[View, tuple[float, float]]
"""A true camera at the resolution of the source, and its distortion (k1, k2)."""


@dataclass(frozen=True)
class _Truth:
    """True cameras of frames and of views without an image, by name, and the way to their world."""

    seen: Mapping[str, Filmed]
    unseen: Mapping[str, Filmed]
    from_scene: Similarity


def run(
    *,
    poses: Path,
    keyframes: Path,
    mesh: Path | None,
    masks: Path,
    depth: list[Path],
    frames: Path,
    masks_truth: Path | None,
    cameras_truth: Path | None,
    mesh_truth: Path | None,
    depth_truth: Path | None,
    metrics: Path,
    dataset: str,
    sequence: str,
    method: str,
    intrinsics: Sequence[float] | None,
    depth_scale: float,
    depth_camera: Mapping[str, Sequence[float]] | None,
    params: EvaluateParams,
    job: Job,
) -> None:
    """Measure what there is a truth for; write metrics.csv.

    Raises
    ------
    UserError
        If a truth cannot be read, does not belong to the frames, or lacks the cameras that it is aligned by.
    """
    for truth_path, what in ((mesh_truth, "mesh"), (depth_truth, "depth")):
        if truth_path is not None and cameras_truth is None:
            raise UserError(
                f"truth.{what}: expected truth.cameras beside it, found none; they tell where {truth_path} lies."
            )
    store, solved = read_frames(frames), read_poses(poses)
    selected, surface = read_keyframes(keyframes), None if mesh is None else read_mesh(mesh)
    generator = np.random.default_rng(job.seed)
    figures = reconstruction_figures(len(solved.views), len(solved.unposed), solved.quality)
    truth = None
    if cameras_truth is not None:
        truth = _read_truth(cameras_truth, intrinsics, solved, store)
        figures += _score_poses(truth, solved)
    if masks_truth is not None:
        figures += _score_masks(masks_truth, masks, surface, truth, selected, store, job)
    maps = {path.name.removesuffix(".zarr.zip"): path for path in depth}
    if mesh_truth is not None:
        exact = read_mesh(mesh_truth)
        figures += _score_depth_by_mesh(exact, maps, truth, selected, solved, params)
    if mesh_truth is not None and surface is not None:
        aligned = Mesh(truth.from_scene.apply(surface.vertices), surface.faces)
        error = measure_mesh(aligned, exact, params.mesh_thresholds, params.surface_samples, generator)
        figures += mesh_figures(error)
    if depth_truth is not None:
        figures += _score_depth_by_images(depth_truth, depth_scale, depth_camera, maps, truth, selected, solved, store)
    if surface is not None:
        figures += soundness_figures(surface)
    if surface is not None and sequence in params.cylinder_sequences:
        figures += cylinder_figures(measure_cylinder(surface, params.surface_samples, generator))
    write_metrics(
        metrics,
        [Metric(item.name, item.value, item.unit, dataset, sequence, method, item.keyframe) for item in figures],
    )
    job.progress.note(f"{len(figures)} figures of {len(selected)} keyframes")


def _read_truth(path: Path, intrinsics: Sequence[float] | None, solved: Poses, store: FrameStore) -> _Truth:
    cameras = read_given_cameras(path, intrinsics)
    found = find_cameras(cameras, store.names, store.indices, numbered=store.ordered)
    seen = {store.names[number]: camera for number, camera in found.items()}
    taken = {camera.name for camera in seen.values()}
    unseen = {_frame_name(camera, store): camera for camera in cameras if camera.name not in taken}
    common = [view for view in solved.views if view.name in seen]
    return _Truth(
        {name: _film(camera, store) for name, camera in seen.items()},
        {name: _film(camera, store) for name, camera in unseen.items()},
        align_poses([view.cam_from_world for view in common], [seen[view.name].cam_from_world for view in common]),
    )


def _frame_name(given: GivenCamera, store: FrameStore) -> str:
    """Name a camera as its frame would be named, so that a mask of the same name is found."""
    if store.ordered and given.video_frame is not None:
        return name_video_frame(given.video_frame)
    return name_video_frame(int(given.name)) if store.ordered and given.name.isdecimal() else given.name


def _film(given: GivenCamera, store: FrameStore) -> Filmed:
    lens = state_size(given.lens, store.source_shape)
    return View(given.name, lens.camera, given.cam_from_world), (lens.k1, lens.k2)


def _score_poses(truth: _Truth, solved: Poses) -> list[Figure]:
    common = [view for view in solved.views if view.name in truth.seen]
    exact = [truth.seen[view.name][0].cam_from_world for view in common]
    error = measure_poses([view.cam_from_world for view in common], exact, truth.from_scene)
    return pose_figures([view.name for view in common], error)


def _score_masks(
    folder: Path,
    masks: Path,
    surface: Mesh | None,
    truth: _Truth | None,
    selected: Mapping[str, Keyframe],
    store: FrameStore,
    job: Job,
) -> list[Figure]:
    unseen = {} if truth is None else truth.unseen
    found = find_masks(folder, [*selected, *store.names, *unseen], numbered=store.ordered)
    overlap = {
        name: intersection_over_union(read_mask(masks / f"{name}.png"), read_mask(file), str(file))
        for name, file in found.items()
        if name in selected
    }
    left_out = sorted(name for name in found if name not in selected and name not in unseen)
    if left_out:
        job.progress.note(f"no score for frames with a true mask that are no keyframes: {', '.join(left_out)}")
    figures = [*mask_figures(overlap), Figure("masks_without_keyframe", len(left_out), "masks")]
    if surface is None:
        return figures
    aligned = None if truth is None else Mesh(truth.from_scene.apply(surface.vertices), surface.faces)
    overlap_unseen = {}
    for name in job.progress.track([name for name in found if name in unseen], "unseen view"):
        view, distortion = unseen[name]
        exact = read_mask(found[name])
        check_mask_size(exact, view.camera.shape, str(found[name]))
        drawn = draw_source_silhouette(aligned, view, distortion, view.camera.shape)
        overlap_unseen[name] = intersection_over_union(drawn, exact)
    return figures + mask_figures(overlap_unseen, "iou_unseen")


def _score_depth_by_mesh(
    exact: Mesh,
    maps: Mapping[str, Path],
    truth: _Truth,
    selected: Mapping[str, Keyframe],
    solved: Poses,
    params: EvaluateParams,
) -> list[Figure]:
    renderer = MeshRenderer(exact)
    pairs = {}
    for name in (name for name in selected if name in truth.seen):
        filmed, distortion = truth.seen[name]
        pixels = filmed_pixels(selected[name].view.camera, solved.distortion, filmed.camera.shape)
        expected = renderer.depth(filmed.cam_from_world, image_points(filmed.camera, distortion, pixels))
        estimated = truth.from_scene.scale * read_depth_map(maps[name]).depth
        pairs[name] = pair_depths(estimated, expected, erosion=params.silhouette_erosion)
    return depth_figures(pairs, "truth unit")


def _score_depth_by_images(
    folder: Path,
    scale: float,
    depth_camera: Mapping[str, Sequence[float]] | None,
    maps: Mapping[str, Path],
    truth: _Truth,
    selected: Mapping[str, Keyframe],
    solved: Poses,
    store: FrameStore,
) -> list[Figure]:
    pairs: dict[str, DepthPairs] = {}
    for name, file in find_depth_images(folder, selected).items():
        colour = truth.seen[name][0].camera if name in truth.seen else None
        image = read_true_depth(file, scale, store.source_shape, depth_camera, colour)
        pixels = filmed_pixels(selected[name].view.camera, solved.distortion, store.source_shape)
        estimated = truth.from_scene.scale * read_depth_map(maps[name]).depth
        pairs[name] = pair_depths(estimated, sample_nearest(image, pixels, np.nan))
    return depth_figures(pairs, "truth unit", "scene_depth")
