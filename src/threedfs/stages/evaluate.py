"""Score a method's mesh and masks against ground truth, where there is any."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from threedfs.crops.border import is_cut_off
from threedfs.evaluate.cylinder import measure_cylinder
from threedfs.evaluate.figures import Figure, cylinder_figures, mask_figures, mesh_figures, soundness_figures
from threedfs.evaluate.masks import check_mask_size, intersection_over_union
from threedfs.evaluate.mesh_error import measure_mesh
from threedfs.evaluate.scores import Metric
from threedfs.evaluate.true_cameras import TrueCameras, relate_cameras
from threedfs.frames.masks import find_masks
from threedfs.frames.true_masks import read_true_mask
from threedfs.io.frames import FrameStore, read_frames
from threedfs.io.given_cameras import read_given_cameras
from threedfs.io.given_meshes import read_given_mesh
from threedfs.io.images import read_mask
from threedfs.io.keyframes import read_keyframes
from threedfs.io.meshes import read_mesh
from threedfs.io.metrics import write_metrics
from threedfs.io.poses import Poses, read_poses
from threedfs.io.volumes import read_silhouettes
from threedfs.job import Job
from threedfs.object.silhouettes import draw_source_silhouette
from threedfs.params.evaluate import EvaluateParams
from threedfs.types import Keyframe, Mesh


def run(
    *,
    poses: Path,
    keyframes: Path,
    mesh: Path | None,
    masks: Path,
    silhouettes: Path,
    crops: Path,
    frames: Path,
    masks_truth: Path | None,
    cameras_truth: Path | None,
    mesh_truth: Path | None,
    metrics: Path,
    dataset: str,
    sequence: str,
    method: str,
    intrinsics: Sequence[float] | None,
    params: EvaluateParams,
    job: Job,
) -> None:
    """Measure what there is a truth for; write metrics.csv.

    Raises
    ------
    UserError
        If a truth cannot be read, does not belong to the frames, or lacks the cameras that it is aligned by.
    """
    store, solved = read_frames(frames), read_poses(poses)
    selected, surface = read_keyframes(keyframes), None if mesh is None else read_mesh(mesh)
    generator = np.random.default_rng(job.seed)
    figures: list[Figure] = []
    truth = aligned = None
    if cameras_truth is not None:
        truth = relate_cameras(read_given_cameras(cameras_truth, intrinsics), solved.views, store)
    if truth is not None and surface is not None:
        aligned = Mesh(truth.from_scene.apply(surface.vertices), surface.faces)
    if masks_truth is not None:
        figures += _score_masks(masks_truth, masks, aligned, truth, selected, store, job)
    figures.append(Figure("masks_cut_off", _count_cut_off(silhouettes, crops, solved, job), "masks"))
    if mesh_truth is not None and aligned is not None:
        exact = read_given_mesh(mesh_truth)
        figures += mesh_figures(measure_mesh(aligned, exact, params.mesh_thresholds, params.surface_samples, generator))
    if surface is not None:
        figures += soundness_figures(surface)
    if surface is not None and sequence in params.cylinder_sequences:
        figures += cylinder_figures(measure_cylinder(surface, params.surface_samples, generator))
    write_metrics(
        metrics,
        [Metric(item.name, item.value, item.unit, dataset, sequence, method, item.keyframe) for item in figures],
    )
    job.progress.note(f"{len(figures)} figures of {len(selected)} keyframes")


def _count_cut_off(silhouettes: Path, crops: Path, solved: Poses, job: Job) -> int:
    """Count the silhouettes that reach a side of their crop where the frame goes on, and name them."""
    whole = {view.name: view.camera for view in solved.views}
    drawn, views = read_silhouettes(silhouettes), {name: entry.view for name, entry in read_keyframes(crops).items()}
    cut = [name for name, mask in drawn.items() if is_cut_off(mask, views[name].camera, whole[name])]
    if cut:
        job.progress.note(
            f"the object reaches the side of its crop in {len(cut)} of {len(drawn)} keyframes, so a part of it may be "
            f"missing: {', '.join(cut)}; raise locate.box_margin, or set crops.whole"
        )
    return len(cut)


def _score_masks(
    folder: Path,
    masks: Path,
    aligned: Mesh | None,
    truth: TrueCameras | None,
    selected: Mapping[str, Keyframe],
    store: FrameStore,
    job: Job,
) -> list[Figure]:
    unseen = {} if truth is None else truth.unseen
    found = find_masks(folder, [*selected, *store.names, *unseen], numbered=store.ordered)
    overlap, inverted = {}, []
    for name in (name for name in found if name in selected):
        mine, exact = read_mask(masks / f"{name}.png"), read_true_mask(found[name])
        overlap[name] = intersection_over_union(mine, exact, str(found[name]))
        if mine.any() and intersection_over_union(mine, ~exact) > overlap[name]:
            inverted.append(name)
    left_out = sorted(name for name in found if name not in selected and name not in unseen)
    if left_out:
        job.progress.note(f"no score for frames with a true mask that are no keyframes: {', '.join(left_out)}")
    figures = [*mask_figures(overlap), Figure("masks_without_keyframe", len(left_out), "masks")]
    if inverted:
        job.progress.note(f"true masks agree better when inverted: {', '.join(inverted)}; is white the object?")
        figures.append(Figure("masks_inverted", len(inverted), "masks"))
    if aligned is None:
        return figures
    overlap_unseen = {}
    for name in job.progress.track([name for name in found if name in unseen], "unseen view"):
        view, distortion = unseen[name]
        exact = read_true_mask(found[name])
        check_mask_size(exact, view.camera.shape, str(found[name]))
        drawn = draw_source_silhouette(aligned, view, distortion, view.camera.shape)
        overlap_unseen[name] = intersection_over_union(drawn, exact)
    return figures + mask_figures(overlap_unseen, "iou_unseen")
