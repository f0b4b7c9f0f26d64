"""Score masks, a mesh or cameras of any program against a truth, or against each other; nothing is estimated."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from threedfs.errors import UserError
from threedfs.evaluate.figures import Figure, mask_figures, mesh_figures, pose_figures, soundness_figures
from threedfs.evaluate.masks import intersection_over_union
from threedfs.evaluate.mesh_error import bounding_diagonal, measure_mesh
from threedfs.evaluate.pose_error import align_poses, measure_poses
from threedfs.frames.picture import name_video_frame
from threedfs.frames.true_masks import check_true_masks, read_true_mask
from threedfs.geometry.similarity import Similarity
from threedfs.io.given_cameras import read_given_cameras
from threedfs.io.given_meshes import read_given_mesh
from threedfs.io.images import read_mask
from threedfs.params.evaluate import EvaluateParams
from threedfs.types import Mesh

_MASK_ENDS = (".png", ".png", ".mask")
"""What is taken off a mask's file name, in this order: `NAME.png.png` is COLMAP's, `NAME.mask.png` OpenMVS's."""


def score_masks(masks: Path, truth: Path) -> list[Figure]:
    """Return the intersection over union of each mask that both folders have, its mean, median and least, and how many.

    Parameters
    ----------
    masks, truth : Path
        Folders of PNG, white on black, of equal names and sizes; `10.png` and `000010.png` are one name.

    Raises
    ------
    UserError
        If they have no name in common, sizes differ, or true masks cannot be ones or are all empty.
    """
    mine, true = _list_masks(masks), _list_masks(truth)
    common = [name for name in mine if name in true]
    if not common:
        first, second = (next(iter(each.values())).name for each in (mine, true))
        raise UserError(
            f"{truth}: expected masks named like those of {masks}, such as {first}, found others, such as {second}; "
            "rename the files of one folder."
        )
    check_true_masks([true[name] for name in common], str(truth))
    overlap = {
        name: intersection_over_union(read_mask(mine[name]), read_true_mask(true[name]), str(true[name]))
        for name in common
    }
    unmatched = len(mine) + len(true) - 2 * len(common)
    counts = [Figure("masks_scored", len(common), "masks"), Figure("masks_unmatched", unmatched, "masks")]
    return [*mask_figures(overlap), *counts]


def score_mesh(mesh: Path, truth: Path, cameras: Path | None = None, true_cameras: Path | None = None) -> list[Figure]:
    """Return how far a mesh is from a true one, in shares of the true one's diagonal, and whether it is sound.

    Parameters
    ----------
    mesh, truth : Path
        In the same coordinates, unless cameras are given.
    cameras, true_cameras : Path, optional
        The same cameras in the coordinates of each mesh: the mesh is moved by what aligns their centres.

    Raises
    ------
    UserError
        If a file cannot be read, the meshes do not meet at all, or cameras are given for one of them only.
    """
    mine, true = read_given_mesh(mesh), read_given_mesh(truth)
    if (cameras is None) != (true_cameras is None):
        raise UserError("score: expected cameras of the mesh and of the true one, or of none, got those of one.")
    if cameras is not None and true_cameras is not None:
        mine = Mesh(_align(cameras, true_cameras)[2].apply(mine.vertices), mine.faces)
    apart = np.linalg.norm(mine.vertices.mean(axis=0) - true.vertices.mean(axis=0))
    if not apart <= bounding_diagonal(true):
        advice = (
            "give --cameras and --true-cameras, by which it is moved there."
            if cameras is None
            else f"give with --cameras those of the mesh itself, as {cameras} has other coordinates or another unit."
        )
        raise UserError(
            f"{mesh}: expected a mesh in the coordinates of {truth}, found its middle farther from the true one's than "
            f"the object is large; {advice}"
        )
    rule = EvaluateParams()
    error = measure_mesh(mine, true, rule.mesh_thresholds, rule.surface_samples, np.random.default_rng(0))
    return [*mesh_figures(error), *soundness_figures(mine)]


def score_cameras(cameras: Path, truth: Path) -> list[Figure]:
    """Return the errors of cameras that both files have, after the similarity that aligns their centres.

    Raises
    ------
    UserError
        If fewer than three are common, or they lie on one line.
    """
    mine, true, similarity = _align(cameras, truth)
    error = measure_poses(list(mine.values()), list(true.values()), similarity)
    return pose_figures(list(mine), error)


def _align(cameras: Path, truth: Path) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray], Similarity]:
    """Return the poses that both files have, by name, and the way from the first file's world to the second's."""
    mine, true = _read_poses(cameras), _read_poses(truth)
    common = [name for name in mine if name in true]
    if len(common) < 3:
        raise UserError(
            f"{truth}: expected at least 3 cameras named like those of {cameras}, such as {next(iter(mine))}, found "
            f"{len(common)}; its own are named like {next(iter(true))}."
        )
    mine, true = {name: mine[name] for name in common}, {name: true[name] for name in common}
    return mine, true, align_poses(list(mine.values()), list(true.values()))


def _read_poses(path: Path) -> dict[str, np.ndarray]:
    poses: dict[str, np.ndarray] = {}
    for camera in read_given_cameras(path):
        name = _name_frame(camera.name)
        if name in poses:
            raise UserError(f"{path}: expected one camera of each frame, found several of {name}; remove all but one.")
        poses[name] = camera.cam_from_world
    return poses


def _name_frame(name: str) -> str:
    """Give the number of a video's frame as many digits as we do: `10` and `000010` are one name."""
    return name_video_frame(int(name)) if name.isdecimal() else name


def _list_masks(folder: Path) -> Mapping[str, Path]:
    found: dict[str, Path] = {}
    for path in sorted(folder.glob("*.png")) if folder.is_dir() else ():
        name = path.name
        for end in _MASK_ENDS:
            name = name.removesuffix(end)
        name = _name_frame(name)
        if name in found:
            raise UserError(
                f"{path}: expected one mask of each frame, found {found[name].name} of the same; remove one."
            )
        found[name] = path
    if not found:
        raise UserError(f"{folder}: expected a folder of masks (PNG, white on black), found none there.")
    return found
