"""The film of a rendered sequence among its results: its truth, and how the reconstruction lies to it."""

from __future__ import annotations

import filecmp
from pathlib import Path

from threedfs.evaluate.true_cameras import TrueCameras, relate_cameras
from threedfs.io.frames import read_frames
from threedfs.io.given_cameras import read_given_cameras
from threedfs.io.poses import read_poses


def find_film(results: Path) -> Path:
    """Return the folder of a rendered sequence's film: its own, or that of a sequence beside it with the same frames.

    Where there is none, its own is named, which does not exist.
    """
    own, frames = results / "00_render", "01_frames/frames.zarr.zip"
    if own.is_dir() or not (results / frames).is_file():
        return own
    films = sorted(results.absolute().parent.glob("*/00_render"))
    others = (film for film in films if (film.parent / frames).is_file())
    return next((film for film in others if filecmp.cmp(results / frames, film.parent / frames, shallow=False)), own)


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
