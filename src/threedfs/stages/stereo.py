"""Slanted patches of one keyframe by patch-match stereo."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from threedfs.depth.zncc import prepare_grey
from threedfs.io.crops import read_crops
from threedfs.io.depth_maps import StereoMap, read_semidense, write_stereo
from threedfs.io.keyframes import read_keyframe
from threedfs.io.volumes import read_support
from threedfs.job import Job
from threedfs.params.rules import make_rule
from threedfs.params.stereo import StereoParams
from threedfs.stereo.patch_match import PatchRule, match_patches
from threedfs.stereo.region import mask_box


def run(
    *,
    crops: Path,
    keyframes: Path,
    semidense: Path,
    support: Path | None,
    stereo: Path,
    keyframe: str,
    params: StereoParams,
    job: Job,
) -> None:
    """Read a keyframe, its neighbours and semi-dense depth; write its patches.

    If the place of the object is given, patches are sought at the pixels that see its box, at any depth: in front of it
    and behind it too.
    """
    frames = read_crops(crops)
    entry = read_keyframe(keyframes, keyframe)
    neighbours = entry.neighbours[: params.views]
    wanted = np.ones(entry.view.camera.shape, bool)
    if support:
        wanted = mask_box(entry.view, read_support(support).box)
    found = match_patches(
        entry.view,
        prepare_grey(frames.image(keyframe), frames.valid_of(keyframe)),
        neighbours,
        [prepare_grey(frames.image(view.name), frames.valid_of(view.name)) for view in neighbours],
        read_semidense(semidense).inverse_depth.astype(np.float64),
        wanted,
        near=entry.near,
        far=entry.far,
        rule=make_rule(PatchRule, params),
        levels=params.levels,
        rounds=params.rounds,
        seed=job.seed,
        note=job.progress.note,
    )
    arrays = {name: values.astype(np.float32) for name, values in vars(found).items()}
    write_stereo(stereo, StereoMap(**arrays), job.header)
