"""The schemas of all artifacts, and the rule that writes each."""

from __future__ import annotations

from pathlib import Path

from threedfs.errors import UserError

FRAMES = "threedfs/frames/1"
CALIBRATION = "threedfs/calibration/1"
POSES = "threedfs/poses/1"
POINTS = "threedfs/sparse-points/1"
KEYFRAMES = "threedfs/keyframes/1"
SEMIDENSE = "threedfs/semidense/1"
EDGES = "threedfs/edges/1"
STEREO = "threedfs/stereo/1"
DEPTH_MAP = "threedfs/depth-map/1"
CONSISTENCY = "threedfs/consistency/1"
VOLUME = "threedfs/volume/1"
ORIENTED_POINTS = "threedfs/oriented-points/1"
SUPERPIXELS = "threedfs/superpixels/1"
SEGMENTATION = "threedfs/segmentation/1"
SUPPORT = "threedfs/support/1"
SILHOUETTES = "threedfs/silhouettes/1"
DEPTH_TRIAL = "threedfs/depth-trial/1"

_RULES = {
    FRAMES: "frames or undistort",
    CALIBRATION: "calibrate",
    POSES: "poses",
    POINTS: "poses",
    KEYFRAMES: "keyframes",
    SEMIDENSE: "semidense",
    EDGES: "edges",
    STEREO: "stereo or stereo_check",
    DEPTH_MAP: "depth",
    CONSISTENCY: "consistency",
    VOLUME: "fuse_scene, fuse_object, fuse_baseline, deform, object or cut_object",
    ORIENTED_POINTS: "densify",
    SUPERPIXELS: "superpixels",
    SEGMENTATION: "segment or volumetric_cut",
    SUPPORT: "locate",
    SILHOUETTES: "object, poisson, pixel_masks or cut_object",
    DEPTH_TRIAL: "depth_trial",
}


def rule_of(schema: str) -> str:
    """Name the rule that writes artifacts of a schema."""
    return _RULES.get(schema, "unknown")


def check_schema(path: Path, found: str | None, expected: str) -> None:
    """Raise a UserError unless the schema found in a file is the one expected."""
    if found != expected:
        raise UserError(
            f"{path}: expected schema {expected}, got {found}; delete the file and run again, "
            f"rule {rule_of(expected)} writes it."
        )
