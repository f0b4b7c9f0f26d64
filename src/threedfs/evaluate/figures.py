"""What was measured, as named figures with units."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from threedfs.evaluate.cylinder import CylinderResidual
from threedfs.evaluate.depth_error import DepthPairs, measure_depth, pool_pairs
from threedfs.evaluate.mesh_error import MeshError, count_pieces, filled_share, find_genus, is_closed
from threedfs.evaluate.pose_error import PoseError
from threedfs.types import Mesh

_QUALITY = (
    ("reprojection_error", "reprojection_error", "px"),
    ("track_length", "track_length", "frames"),
    ("triangulation_angle", "triangulation_angle", "deg"),
    ("step_ratio", "path_continuity", "largest / median step"),
    ("turns", "path_turns", "turns"),
)


@dataclass(frozen=True)
class Figure:
    """One figure: its name, value, unit, and the frame it belongs to (empty: the whole sequence)."""

    name: str
    value: float
    unit: str
    keyframe: str = ""


def mask_figures(overlap: Mapping[str, float], name: str = "iou") -> list[Figure]:
    """Return the intersection over union of each frame, then its mean, median and least value."""
    if not overlap:
        return []
    values = np.array(list(overlap.values()))
    return [
        *(Figure(name, value, "1", frame) for frame, value in overlap.items()),
        Figure(f"{name}_mean", float(values.mean()), "1"),
        Figure(f"{name}_median", float(np.median(values)), "1"),
        Figure(f"{name}_min", float(values.min()), "1"),
    ]


def depth_figures(pairs: Mapping[str, DepthPairs], unit: str, name: str = "depth") -> list[Figure]:
    """Return the median relative error of each keyframe, then all figures over the pixels of all keyframes.

    Parameters
    ----------
    pairs : mapping of str to DepthPairs
        By keyframe.
    unit : str
        Of the depths.
    name : str
        Put before each name.
    """
    measured = {keyframe: measure_depth(pair) for keyframe, pair in pairs.items()}
    figures = [
        Figure(f"{name}_error", 100 * error.median, "%", keyframe) for keyframe, error in measured.items() if error
    ]
    if not figures:
        return []
    pooled = measure_depth(pool_pairs(list(pairs.values())))
    return [
        *figures,
        Figure(f"{name}_error_median", 100 * pooled.median, "%"),
        Figure(f"{name}_error_mean", 100 * pooled.mean, "%"),
        Figure(f"{name}_within_1", 100 * pooled.within_1, "%"),
        Figure(f"{name}_within_10", 100 * pooled.within_10, "%"),
        Figure(f"{name}_rmse", pooled.rmse, unit),
        Figure(f"{name}_covered", 100 * pooled.covered, "%"),
    ]


def pose_figures(frames: Sequence[str], error: PoseError) -> list[Figure]:
    """Return the centre and rotation error of each frame, then their medians and largest values."""
    centre, rotation = 100 * error.centre, np.rad2deg(error.rotation)
    extent = "% of path extent"
    return [
        *(
            Figure("pose_centre_error", float(value), extent, frame)
            for frame, value in zip(frames, centre, strict=True)
        ),
        *(
            Figure("pose_rotation_error", float(value), "deg", frame)
            for frame, value in zip(frames, rotation, strict=True)
        ),
        Figure("pose_centre_error_median", float(np.median(centre)), extent),
        Figure("pose_centre_error_max", float(centre.max()), extent),
        Figure("pose_rotation_error_median", float(np.median(rotation)), "deg"),
        Figure("pose_rotation_error_max", float(rotation.max()), "deg"),
    ]


def reconstruction_figures(posed: int, unposed: int, quality: Mapping[str, float]) -> list[Figure]:
    """Return the share of the working frames with a pose, and the figures that pose estimation found of itself."""
    return [
        Figure("frames_posed", 100 * posed / (posed + unposed), "%"),
        *(Figure(name, float(quality[key]), unit) for key, name, unit in _QUALITY if key in quality),
    ]


def mesh_figures(error: MeshError) -> list[Figure]:
    """Return distances, precision, recall and F-score at each threshold, the share far away, and the normals' error."""
    diagonal = "% of diagonal"
    return [
        Figure("mesh_accuracy", 100 * error.accuracy, diagonal),
        Figure("mesh_completeness", 100 * error.completeness, diagonal),
        Figure("mesh_chamfer", 100 * error.chamfer, diagonal),
        *(
            Figure(f"mesh_{name}_{agreement.threshold:g}", getattr(agreement, name), "1")
            for agreement in error.agreement
            for name in ("precision", "recall", "f_score")
        ),
        Figure("mesh_far_share", 100 * error.far_share, "%"),
        Figure("mesh_normal_error", error.normal_error, "deg"),
    ]


def soundness_figures(mesh: Mesh) -> list[Figure]:
    """Return whether a mesh is closed, its pieces and handles, and what share of its bounding box it fills."""
    closed = is_closed(mesh)
    return [
        Figure("mesh_closed", float(closed), "1"),
        Figure("mesh_pieces", float(count_pieces(mesh)), "pieces"),
        *([Figure("mesh_genus", float(find_genus(mesh)), "handles")] if closed else []),
        Figure("mesh_filled", filled_share(mesh), "1"),
    ]


def cylinder_figures(residual: CylinderResidual) -> list[Figure]:
    """Return the median and 90th percentile of the distance of a can's side from its own best-fit cylinder."""
    return [
        Figure("cylinder_residual_median", 100 * residual.median, "% of radius"),
        Figure("cylinder_residual_p90", 100 * residual.percentile_90, "% of radius"),
    ]


def photo_figures(photos: np.ndarray) -> list[Figure]:
    """Return the mean PSNR and SSIM over photographs, of a textured mesh and of one with colours at its vertices.

    Parameters
    ----------
    photos : (N, 4) float64
        PSNR and SSIM of the one and of the other against each photograph; no figures without any.
    """
    if not len(photos):
        return []
    names = ("photo_psnr", "photo_ssim", "photo_psnr_vertices", "photo_ssim_vertices")
    means = zip(names, photos.mean(axis=0), ("dB", "1", "dB", "1"), strict=True)
    return [*(Figure(name, float(value), unit) for name, value, unit in means), Figure("photos", len(photos), "photos")]
