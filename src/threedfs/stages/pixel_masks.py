"""The object's masks from the labels of pixels, in the frames as they were filmed."""

from __future__ import annotations

from pathlib import Path

from threedfs.io.frames import read_frames
from threedfs.io.images import write_mask
from threedfs.io.keyframes import read_keyframes
from threedfs.io.poses import read_poses
from threedfs.io.segmentation import read_segmentation
from threedfs.io.volumes import write_silhouettes
from threedfs.job import Job
from threedfs.segment.source_mask import distort_mask


def run(
    *, labels: Path, keyframes: Path, poses: Path, frames: Path, silhouettes: Path, masks: Path, method: str, job: Job
) -> None:
    """Read a segmentation; write its masks in working and in source frames."""
    drawn = read_segmentation(labels).masks
    write_silhouettes(silhouettes, drawn, job.header)
    posed, source_shape = read_poses(poses), read_frames(frames).source_shape
    whole = {view.name: view.camera for view in posed.views}
    masks.mkdir(parents=True, exist_ok=True)
    for name, entry in read_keyframes(keyframes).items():
        mask = distort_mask(drawn[name], entry.view.camera, whole[name], posed.distortion, source_shape)
        write_mask(masks / f"{name}.png", mask)
    job.progress.note(f"{method}: {len(drawn)} masks")
