"""Find the object in a field on its own grid."""

from __future__ import annotations

from pathlib import Path

from threedfs.io.keyframes import read_keyframes
from threedfs.io.located import write_located
from threedfs.io.point_clouds import read_semidense_points
from threedfs.io.volumes import read_support, read_volume
from threedfs.job import Job
from threedfs.locate.find import find_object
from threedfs.locate.height import least_height
from threedfs.params.locate_object import LocateObjectParams


def run(
    *,
    volume: Path,
    support: Path,
    keyframes: Path,
    semidense: list[Path],
    located: Path,
    field: str,
    params: LocateObjectParams,
    job: Job,
) -> None:
    """Read a field, as fused, corrected or of a baseline; write the voxels of the object in it."""
    fused, place, entries = read_volume(volume), read_support(support), read_keyframes(keyframes)
    found = find_object(
        fused.grid,
        fused.sdf,
        fused.seen,
        place,
        [entry.view for entry in entries.values()],
        read_semidense_points(entries, semidense, params.point_deviation),
        least_height=least_height(
            params.clearance, params.noise_clearance, fused.grid.spacing, place.figures["plane_noise"]
        ),
        reach=params.object_reach,
    )
    job.progress.note(f"{field}: {found.voxels.sum()} voxels, {found.rivals} other components left out")
    write_located(located, found, job.header)
