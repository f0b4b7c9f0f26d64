"""Find the keypoints of all working frames."""

from __future__ import annotations

from pathlib import Path

from threedfs.colmap.features import extract_features
from threedfs.io.features import write_features
from threedfs.io.frames import read_frames
from threedfs.job import Job
from threedfs.params.features import FeaturesParams
from threedfs.poses.gates import check_features


def run(*, frames: Path, features: Path, params: FeaturesParams, job: Job) -> None:
    """Read the frames; write features.zarr.zip.

    Raises
    ------
    UserError
        If the frames show too little to find their cameras by.
    """
    store = read_frames(frames)
    found = extract_features(
        (store.image(name) for name in job.progress.track(store.names, "frames read")),
        max_features=params.max_features,
        min_contrast=params.min_contrast,
        threads=job.threads,
    )
    median = check_features(found, params.min_features)
    job.progress.note(f"median of {median:.0f} keypoints a frame")
    write_features(features, found, job.header)
