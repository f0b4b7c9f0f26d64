"""Choose keyframes, their neighbours and depth ranges."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from threedfs.frames.masks import find_masks
from threedfs.io.frames import read_frames
from threedfs.io.keyframes import write_keyframes
from threedfs.io.points import read_points
from threedfs.io.poses import read_poses
from threedfs.job import Job
from threedfs.keyframes.depth_range import expect_depth_range
from threedfs.keyframes.neighbours import NeighbourRule, choose_neighbours
from threedfs.keyframes.sectors import cluster_photos, score_frames, split_sequence
from threedfs.keyframes.selection import choose_keyframes, viewing_directions
from threedfs.keyframes.visibility import find_visibility
from threedfs.params.keyframes import KeyframesParams
from threedfs.types import Keyframe


def run(
    *,
    undistorted: Path,
    poses: Path,
    points: Path,
    masks: Path | None,
    keyframes: Path,
    params: KeyframesParams,
    job: Job,
) -> None:
    """Read frames, poses and points; write keyframes.json.

    Raises
    ------
    UserError
        If a keyframe has fewer than 10 sparse points in view, or no mask belongs to a posed frame.
    """
    store = read_frames(undistorted)
    views = read_poses(poses).views
    visibility = find_visibility(views, read_points(points), store.valid)
    names = [view.name for view in views]
    masked = {} if masks is None else find_masks(masks, names, numbered=store.ordered)
    annotated = np.array([name in masked for name in names])
    score = score_frames(visibility, params.distance_weight, params.usage_weight)
    divide = split_sequence if store.ordered else cluster_photos
    sharpness = dict(zip(store.names, store.sharpness, strict=True))
    chosen = choose_keyframes(
        sector=divide(score, params.new_keyframe_score),
        directions=viewing_directions(views, visibility.xyz),
        sharpness=np.array([sharpness[name] for name in names]),
        forced=annotated,
        count=params.max_keyframes,
        max_gap=params.max_gap,
    )
    rule = NeighbourRule(
        count=params.neighbours,
        min_count=params.min_neighbours,
        min_angle=params.min_angle,
        max_angle=params.max_angle,
        widest_angle=params.widest_angle,
        min_overlap=params.min_overlap,
        min_shared=params.min_shared,
    )
    entries = []
    for frame in job.progress.track(chosen, "keyframes"):
        near, far = expect_depth_range(visibility.depth[frame], params.near_factor, params.far_factor, names[frame])
        neighbours = tuple(views[other] for other in choose_neighbours(visibility, frame, rule))
        entries.append(Keyframe(views[frame], neighbours, near, far))
    write_keyframes(keyframes, entries, job.header)
    fewest = min(len(entry.neighbours) for entry in entries)
    job.progress.note(
        f"{len(entries)} keyframes of {len(views)} frames, {int(annotated.sum())} of them annotated; "
        f"at least {fewest} neighbours each"
    )
