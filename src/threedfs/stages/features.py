"""Find the keypoints of working frames."""

from __future__ import annotations

from pathlib import Path

import cv2

from threedfs.io.features import write_features
from threedfs.io.frames import read_frames
from threedfs.job import Job
from threedfs.params.features import FeaturesParams
from threedfs.poses.gates import check_features
from threedfs.poses.keypoints import choose_frames, find_keypoints


def run(*, frames: Path, features: Path, params: FeaturesParams, job: Job) -> None:
    """Read the frames; write features.zarr.zip.

    Raises
    ------
    UserError
        If the frames show too little to find their cameras by.
    """
    cv2.setNumThreads(1)  # threads are given whole frames
    store = read_frames(frames)
    chosen = choose_frames(store.times, params.max_frames, params.max_gap, ordered=store.ordered)
    found = find_keypoints(
        lambda number: store.image(store.names[number]),
        chosen,
        max_features=params.max_features if store.ordered else params.max_photo_features,
        min_contrast=params.min_contrast,
        threads=job.threads,
    )
    median = check_features(list(found.values()), params.min_features)
    job.progress.note(f"median of {median:.0f} keypoints in each of {len(chosen)} frames")
    write_features(features, found, job.header)
