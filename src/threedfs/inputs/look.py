"""A look at the files of a sequence: what any stage would refuse, without decoding more than a few pictures."""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from threedfs.errors import UserError
from threedfs.frames.decode import choose_step, scan_source
from threedfs.frames.masks import check_mask_sizes, find_masks
from threedfs.frames.photos import Photos
from threedfs.frames.scale import working_shape
from threedfs.frames.true_masks import check_true_masks, read_true_mask
from threedfs.frames.video import Video
from threedfs.inputs.outline import compare_outlines, see_points
from threedfs.io.given_cameras import read_given_cameras
from threedfs.io.given_meshes import read_given_mesh
from threedfs.io.truth import read_depth_image, read_true_depth
from threedfs.io.truth_files import choose_spread, find_depth_images
from threedfs.poses.given import GivenCamera, check_enough_given, find_cameras, fit_lens, shared_distortion
from threedfs.progress import Progress

_MASKS_LOOKED_AT, _DEPTHS_LOOKED_AT, _VIEWS_ASKED, _OUTLINES_COMPARED = 24, 3, 24, 5
_LEAST_AGREEMENT = 0.7
"""Of the outlines of true mesh and masks: right ones agree by more than nine tenths."""


def look(entry: Mapping[str, Any], frames: Mapping[str, Any]) -> list[str]:
    """Look at source, cameras, calibration and truth of a sequence.

    Parameters
    ----------
    entry, frames : mapping
        As `find_fault` takes them.

    Returns
    -------
    list of str
        What looks odd.

    Raises
    ------
    UserError
        If a file cannot be used.
    """
    source = _scan(Path(entry["source"]))
    _check_count(source, frames["min_frames"])
    if entry["calibration"] is not None:
        _scan(Path(entry["calibration"]))
    if entry["cameras"] is not None:
        _look_at_cameras(source, Path(entry["cameras"]), entry["intrinsics"], frames)
    masks, cameras = {}, {}
    if entry["truth_masks"] is not None:
        masks = _look_at_masks(source, Path(entry["truth_masks"]))
    if entry["truth_cameras"] is not None:
        cameras = _find_true_cameras(source, Path(entry["truth_cameras"]), entry["intrinsics"])
    if entry["truth_depth"] is not None:
        _look_at_depth(source, Path(entry["truth_depth"]), entry["depth_scale"], entry["depth_camera"] is None)
    if entry["truth_mesh"] is not None:
        return _look_at_mesh(Path(entry["truth_mesh"]), cameras, masks)
    return []


def _scan(path: Path) -> Video | Photos:
    return scan_source(path, Progress("", io.StringIO()))  # the stage tells what it leaves out


def _check_count(source: Video | Photos, least: int) -> None:
    if len(source.names) < least:
        lost = f" and {source.unreadable} that cannot be read" if source.unreadable else ""
        advice = "film the object for longer" if source.ordered else "take more photos of the object"
        raise UserError(f"{source.path}: expected at least {least} frames, got {len(source.names)}{lost}; {advice}.")


def _look_at_cameras(
    source: Video | Photos, path: Path, intrinsics: list[float] | None, frames: Mapping[str, Any]
) -> None:
    cameras = read_given_cameras(path, intrinsics)
    count = len(source.names)
    found = find_cameras(cameras, source.names, np.arange(count), numbered=source.ordered)
    shape = working_shape(source.shape, frames["longest_side"])
    shared_distortion([fit_lens(camera.lens, source.shape, shape) for camera in found.values()])
    taken = range(0, count, choose_step(count, frames["max_frames"]))
    check_enough_given(len(set(taken) & set(found)), len(taken))


def _look_at_masks(source: Video | Photos, folder: Path) -> dict[str, Path]:
    masks = find_masks(folder, source.names, numbered=source.ordered)
    check_mask_sizes(masks, source.shape)
    first = choose_spread(list(masks), _MASKS_LOOKED_AT)
    order = dict.fromkeys([*first, *masks])
    check_true_masks([masks[name] for name in order], str(folder), enough=len(first))
    return masks


def _find_true_cameras(source: Video | Photos, path: Path, intrinsics: list[float] | None) -> dict[str, GivenCamera]:
    cameras = read_given_cameras(path, intrinsics)
    try:
        found = find_cameras(cameras, source.names, np.arange(len(source.names)), numbered=source.ordered)
        for camera in found.values():
            fit_lens(camera.lens, source.shape, source.shape)
    except UserError as fault:
        raise UserError(f"{path}: {str(fault).removeprefix('poses: ')}") from fault
    return {source.names[number]: camera for number, camera in found.items()}


def _look_at_depth(source: Video | Photos, folder: Path, scale: float, registered: bool) -> None:
    images = find_depth_images(folder, source.names)
    read = [
        read_true_depth(images[name], scale, source.shape) if registered else read_depth_image(images[name], scale)
        for name in choose_spread(list(images), _DEPTHS_LOOKED_AT)
    ]
    if not any(np.isfinite(depth).any() for depth in read):
        raise UserError(f"{folder}: expected depth images, got {len(read)} without any depth; check the files.")


def _look_at_mesh(path: Path, cameras: Mapping[str, GivenCamera], masks: Mapping[str, Path]) -> list[str]:
    mesh = read_given_mesh(path)
    vertices = mesh.vertices[np.unique(mesh.faces)]
    asked = choose_spread(list(cameras), _VIEWS_ASKED)
    if not any(see_points(vertices, cameras[name]) for name in asked):
        raise UserError(
            f"{path}: expected a mesh in the coordinates of the true cameras, got one that none of them sees (of "
            f"{len(asked)} asked); give mesh and cameras of one sequence."
        )
    both = choose_spread([name for name in masks if name in cameras], _OUTLINES_COMPARED)
    agreement = [compare_outlines(vertices, cameras[name], read_true_mask(masks[name])) for name in both]
    found = [value for value in agreement if value is not None]
    if found and np.median(found) < _LEAST_AGREEMENT:
        return [
            f"{path}: seen by the true cameras, the true mesh covers other places than the true masks (overlap of the "
            f"outlines {np.median(found):.2f}); are mesh, cameras and masks of this sequence?"
        ]
    return []
