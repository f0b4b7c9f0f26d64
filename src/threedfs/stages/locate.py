"""Find the support plane and the box of the object in the fused scene."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from threedfs.io.keyframes import read_keyframes
from threedfs.io.point_clouds import read_semidense_points
from threedfs.io.points import read_points
from threedfs.io.volumes import read_volume, write_support
from threedfs.job import Job
from threedfs.locate.scene import SceneRule, find_in_scene
from threedfs.params.locate import LocateParams
from threedfs.params.rules import make_rule


def run(
    *,
    scene: Path,
    keyframes: Path,
    points: Path,
    semidense: list[Path],
    support: Path,
    clearance: float,
    params: LocateParams,
    job: Job,
) -> None:
    """Read the scene's volume and the points; write the plane and the object's box.

    `clearance` is the least height above the plane from which voxels may belong to the object, voxels.
    """
    volume = read_volume(scene)
    entries = read_keyframes(keyframes)
    found = find_in_scene(
        volume.grid,
        volume.sdf,
        volume.seen,
        [entry.view for entry in entries.values()],
        read_points(points).xyz,
        read_semidense_points(entries, semidense, params.point_deviation),
        make_rule(SceneRule, params, clearance=clearance),
        np.random.default_rng(job.seed),
    )
    figures = found.figures
    job.progress.note(
        f"support plane with {figures['plane_share']:.0%} of the nearby upward-facing surface; object of "
        f"{figures['object_voxels']:.0f} voxels, {figures['supported_voxels']:.0f} of them with semi-dense points, "
        f"before {figures['rival_components']:.0f} other components"
    )
    write_support(support, found, job.header)
