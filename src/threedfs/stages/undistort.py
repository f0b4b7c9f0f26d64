"""Remove the radial distortion from the frames (Section 3.1)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from threedfs.frames.undistort import assign_cameras, undistort_image, valid_pixels
from threedfs.io.frames import Frame, read_frames, write_frames
from threedfs.io.poses import read_poses
from threedfs.job import Job


def run(*, frames: Path, poses: Path, undistorted: Path, job: Job) -> None:
    """Read frames and poses; write undistorted.zarr.zip: the same frames, undistorted, and their valid pixels.

    Raises
    ------
    UserError
        If the cameras are not of the frames' size.
    """
    store = read_frames(frames)
    posed = read_poses(poses)
    cameras = assign_cameras(store.names, store.shape, {view.name: view.camera for view in posed.views})
    distinct = dict.fromkeys(cameras)
    valid = np.logical_and.reduce([valid_pixels(camera, posed.distortion) for camera in distinct])

    def undistort():
        for row in job.progress.track(range(len(store.names)), "frame"):
            image = undistort_image(store.image(store.names[row]), cameras[row], posed.distortion)
            yield Frame(
                name=store.names[row],
                index=int(store.indices[row]),
                time=float(store.times[row]),
                sharpness=float(store.sharpness[row]),
                image=image,
            )

    write_frames(
        undistorted,
        undistort(),
        job.header,
        ordered=store.ordered,
        source_shape=store.source_shape,
        valid=valid,
        skipped=store.skipped,
    )
    k1, k2 = posed.distortion
    job.progress.note(f"k1 = {k1:.4g}, k2 = {k2:.4g}; {valid.mean():.1%} of the pixels show the scene in every frame")
