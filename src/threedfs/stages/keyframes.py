"""Choose keyframes, their neighbours and depth ranges."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from threedfs.crops.resample import find_valid
from threedfs.errors import UserError
from threedfs.frames.masks import find_masks
from threedfs.geometry.lens import Lens
from threedfs.io.frames import read_frames
from threedfs.io.keyframes import write_keyframes
from threedfs.io.points import read_points
from threedfs.io.poses import read_poses
from threedfs.job import Job
from threedfs.keyframes.depth_range import LEAST_POINTS, expect_depth_range
from threedfs.keyframes.neighbours import NeighbourRule, choose_neighbours
from threedfs.keyframes.sectors import cluster_photos, divide_finely_enough, score_frames, split_sequence
from threedfs.keyframes.selection import choose_keyframes, viewing_directions
from threedfs.keyframes.visibility import find_visibility
from threedfs.params.keyframes import KeyframesParams
from threedfs.params.rules import make_rule
from threedfs.types import Keyframe


def run(
    *,
    frames: Path,
    poses: Path,
    points: Path,
    masks: Path | None,
    keyframes: Path,
    params: KeyframesParams,
    job: Job,
) -> None:
    """Read frames, poses and points; write keyframes.json.

    Differs from the paper: LSD-SLAM's criterion (3.1) only parts the path into sectors. Each offers its sharpest frame,
    and of these the farthest apart become keyframes. Frames of the given masks always do, for their sectors.

    Raises
    ------
    UserError
        If no frame can be a keyframe, or one with a mask cannot, for want of points in view or of neighbours; or if
        no mask belongs to a posed frame.
    """
    store, posed = read_frames(frames), read_poses(poses)
    views = posed.views
    lenses = dict.fromkeys(Lens(view.camera, *posed.distortion) for view in views)
    valid = np.logical_and.reduce([find_valid(lens, lens.camera) for lens in lenses])
    visibility = find_visibility(views, read_points(points), valid)
    names = [view.name for view in views]
    masked = {} if masks is None else find_masks(masks, names, numbered=store.ordered)
    annotated = np.array([name in masked for name in names])
    # Frames with a mask stay, so that what is wrong with them is told.
    usable = np.flatnonzero((visibility.in_view.sum(axis=1) >= LEAST_POINTS) | annotated)
    blind = [names[frame] for frame in np.setdiff1d(np.arange(len(names)), usable)]
    _note_left_out(job, blind, "too few sparse points in view")
    if len(usable) == 0:
        raise UserError(
            f"No frame has {LEAST_POINTS} sparse points in view; expected cameras that look at the sparse points; "
            "check that the given cameras belong to these frames."
        )
    score = score_frames(visibility, params.distance_weight, params.usage_weight)
    enough = annotated[usable].sum() >= params.max_keyframes  # frames with a mask alone
    sector = divide_finely_enough(
        split_sequence if store.ordered else cluster_photos,
        score[np.ix_(usable, usable)],
        params.new_keyframe_score,
        params.least_score_share * params.new_keyframe_score,
        0 if enough else params.max_keyframes,
    )
    sharpness = dict(zip(store.names, store.sharpness, strict=True))
    chosen = choose_keyframes(
        sector=sector,
        directions=viewing_directions([views[frame] for frame in usable], visibility.xyz),
        sharpness=np.array([sharpness[names[frame]] for frame in usable]),
        forced=annotated[usable],
        count=params.max_keyframes,
        max_gap=params.max_gap,
    )
    rule = make_rule(NeighbourRule, params, count=params.neighbours, min_count=params.min_neighbours)
    entries, alone = [], []
    for frame in job.progress.track(usable[chosen], "keyframes"):
        near, far = expect_depth_range(visibility.depth[frame], params.near_factor, params.far_factor, names[frame])
        neighbours = tuple(views[other] for other in choose_neighbours(visibility, frame, rule))
        if neighbours:
            entries.append(Keyframe(views[frame], neighbours, near, far))
        elif annotated[frame]:
            raise UserError(
                f"keyframe {names[frame]}: expected frames that see its points from another place, got none; remove "
                "its mask, or film so that the camera moves."
            )
        else:
            alone.append(names[frame])
    _note_left_out(job, alone, "points that no frame sees from another place")
    if not entries:
        raise UserError(
            "No frame sees its points from another place, so there is no depth; expected a camera that moves around "
            "the object; check the given cameras, or film again."
        )
    angle = float(np.median([entry.neighbour_angle for entry in entries]))
    write_keyframes(keyframes, entries, job.header, needs_stereo=angle >= params.stereo_angle)
    fewest = min(len(entry.neighbours) for entry in entries)
    job.progress.note(
        f"{len(entries)} keyframes of {len(views)} frames, {int(annotated.sum())} of them annotated; "
        f"at least {fewest} neighbours each, {angle:.0f} degrees away in the median"
    )


def _note_left_out(job: Job, names: list[str], reason: str) -> None:
    if names:
        job.progress.note(f"no keyframes, because of {reason}: {', '.join(names)}")
