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
from threedfs.frames.picture import name_video_frame
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
from threedfs.types import Keyframe, Mesh, View

_NAMED = 8
"""Masks that are left out, named one by one."""


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
        figures += _score_masks(masks_truth, masks, surface, aligned, truth, selected, solved, store, job)
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
    surface: Mesh | None,
    aligned: Mesh | None,
    truth: TrueCameras | None,
    selected: Mapping[str, Keyframe],
    solved: Poses,
    store: FrameStore,
    job: Job,
) -> list[Figure]:
    """Score masks of keyframes, and the mesh as it is drawn at other true masks whose camera is known.

    No truth chooses a frame, so a mask may be of any frame of the source: one that was worked on has the camera that
    was estimated for it, one of a true camera without an image that camera. Others are left out, and counted.
    """
    unseen = {} if truth is None else truth.unseen
    files = _list_masks(folder, [*selected, *store.names, *unseen], store)
    posed = {view.name: view for view in solved.views}
    at_keyframe = [name for name in files if name in selected]
    at_frame = [name for name in files if name in posed and name not in selected and surface is not None]
    at_unseen = [name for name in files if name in unseen and aligned is not None]
    overlap, inverted = {}, []
    for name in at_keyframe:
        mine, exact = read_mask(masks / f"{name}.png"), read_true_mask(files[name])
        overlap[name] = intersection_over_union(mine, exact, str(files[name]))
        if mine.any() and intersection_over_union(mine, ~exact) > overlap[name]:
            inverted.append(name)
    without_keyframe = [name for name in files if name not in selected and name not in unseen]
    left_out = [name for name in files if name not in {*at_keyframe, *at_frame, *at_unseen}]
    if left_out:
        why = "no camera is known there" if surface is not None else "without a mesh, only keyframes have masks"
        job.progress.note(
            f"{len(left_out)} of {len(files)} true masks are scored nowhere: {_name_some(sorted(left_out))}; {why}; "
            "give masks of frames that are worked on, their truth.cameras, or set keyframes_at_truth"
        )
    drawn = {}
    if surface is not None:
        drawn = {name: (surface, posed[name], solved.distortion, store.source_shape) for name in at_frame}
    elsewhere = _compare_drawn(drawn, files, job)
    figures = [
        *mask_figures(overlap | elsewhere),
        *mask_figures(elsewhere, "iou_frames"),
        Figure("masks_without_keyframe", len(without_keyframe), "masks"),
    ]
    if left_out:
        figures.append(Figure("masks_left_out", len(left_out), "masks"))
    if inverted:
        job.progress.note(f"true masks agree better when inverted: {_name_some(inverted)}; is white the object?")
        figures.append(Figure("masks_inverted", len(inverted), "masks"))
    drawn = {}
    if aligned is not None:
        drawn = {name: (aligned, *unseen[name], unseen[name][0].camera.shape) for name in at_unseen}
    return figures + mask_figures(_compare_drawn(drawn, files, job), "iou_unseen")


def _list_masks(folder: Path, known: Sequence[str], store: FrameStore) -> dict[str, Path]:
    """Return the mask files by frame: first those of known ones, then those of no known frame, by their own names."""
    numbers = [path.stem for path in sorted(folder.glob("*.png")) if path.stem.isascii() and path.stem.isdigit()]
    others = [name_video_frame(int(number)) for number in numbers] if store.ordered else []
    found = find_masks(folder, [*known, *others], numbered=store.ordered)
    taken = {path.name for path in found.values()}
    strange = [path for path in sorted(folder.glob("[!.]*.png")) if path.name not in taken]
    return found | {path.stem: path for path in strange}


def _compare_drawn(
    drawn: Mapping[str, tuple[Mesh, View, tuple[float, float], tuple[int, int]]], files: Mapping[str, Path], job: Job
) -> dict[str, float]:
    """Draw a mesh in views, each with its distortion and shape, and compare it with the true masks of their names."""
    overlap = {}
    for name in job.progress.track([*drawn], "view without a mask"):
        exact, (mesh, view, distortion, shape) = read_true_mask(files[name]), drawn[name]
        check_mask_size(exact, shape, str(files[name]))
        overlap[name] = intersection_over_union(draw_source_silhouette(mesh, view, distortion, shape), exact)
    return overlap


def _name_some(names: Sequence[str]) -> str:
    """Return names in one line, the first few of many."""
    return ", ".join(names[:_NAMED]) + (f" and {len(names) - _NAMED} more" if len(names) > _NAMED else "")
