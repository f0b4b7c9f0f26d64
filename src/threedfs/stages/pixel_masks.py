"""The object's masks from the labels of pixels, in the frames as they were filmed."""

from __future__ import annotations

from pathlib import Path

from threedfs.io.frames import read_frames
from threedfs.io.keyframes import read_views
from threedfs.io.outlines import write_masks
from threedfs.io.poses import read_poses
from threedfs.io.segmentation import read_segmentation
from threedfs.job import Job


def run(
    *, labels: Path, keyframes: Path, poses: Path, frames: Path, silhouettes: Path, masks: Path, method: str, job: Job
) -> None:
    """Read a segmentation; write its masks in working and in source frames."""
    drawn, posed = read_segmentation(labels).masks, read_poses(poses)
    views, whole = read_views(keyframes), {view.name: view for view in posed.views}
    source_shape = read_frames(frames).source_shape
    write_masks(silhouettes, masks, drawn, views, whole, posed.distortion, source_shape, job.header)
    job.progress.note(f"{method}: {len(drawn)} masks")
