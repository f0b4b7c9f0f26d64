"""The film of a rendered sequence among its results: its truth, and how the reconstruction lies to it."""

from __future__ import annotations

from pathlib import Path

from threedfs.evaluate.true_cameras import TrueCameras, relate_cameras
from threedfs.io.frames import read_frames
from threedfs.io.given_cameras import read_given_cameras
from threedfs.io.poses import read_poses


def find_film(results: Path) -> Path:
    """Return the folder of a rendered sequence's film; a twin with given poses, NAME_posed, has that of its take."""
    own = results / "00_render"
    return own if own.is_dir() else results.with_name(results.name.removesuffix("_posed")) / "00_render"


def relate_film(results: Path) -> TrueCameras:
    """Return the true cameras of a rendered sequence, and the way from its reconstruction's world to theirs.

    Raises
    ------
    UserError
        If the folder does not hold the results of a rendered sequence.
    """
    return relate_cameras(
        read_given_cameras(find_film(results) / "cameras.json", None),
        read_poses(results / "02_poses/poses.json").views,
        read_frames(results / "01_frames/frames.zarr.zip"),
    )
