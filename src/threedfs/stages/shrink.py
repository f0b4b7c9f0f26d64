"""Small whole frames, in which the scene is looked at once to find the object."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from threedfs.crops.place import shrink_view
from threedfs.crops.resample import resample
from threedfs.geometry.lens import Lens
from threedfs.io.crops import Crop, write_crops
from threedfs.io.frames import read_frames
from threedfs.io.keyframes import read_keyframes, read_needs_stereo, write_keyframes
from threedfs.io.poses import read_poses
from threedfs.job import Job
from threedfs.params.shrink import ShrinkParams
from threedfs.read_ahead import read_ahead


def run(
    *, frames: Path, poses: Path, keyframes: Path, crops: Path, views: Path, params: ShrinkParams, job: Job
) -> None:
    """Read working frames; write the keyframes and their neighbours, undistorted and small."""
    store, posed, entries = read_frames(frames), read_poses(poses), read_keyframes(keyframes)
    wanted = {view.name for entry in entries.values() for view in (entry.view, *entry.neighbours)}
    filmed = {view.name: view for view in posed.views if view.name in wanted}
    small = {name: shrink_view(view, params.longest_side) for name, view in filmed.items()}

    def undistort():
        for name in job.progress.track(sorted(filmed), "frame"):
            lens = Lens(filmed[name].camera, *posed.distortion)
            yield Crop(name, *resample(store.image(name), lens, small[name].camera))

    write_crops(
        crops,
        read_ahead(undistort(), threads=job.threads),
        job.header,
        ordered=store.ordered,
        source_shape=store.source_shape,
    )
    moved = [
        replace(entry, view=small[entry.view.name], neighbours=tuple(small[view.name] for view in entry.neighbours))
        for entry in entries.values()
    ]
    write_keyframes(views, moved, job.header, needs_stereo=read_needs_stereo(keyframes))
