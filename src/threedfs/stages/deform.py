"""Move the zero level of the object's field onto the surface points."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from threedfs.deform.bridges import keep_apart
from threedfs.deform.correction import CorrectionRule, correct_zero_crossing
from threedfs.deform.evidence import (
    average_in_cells,
    believe_scattered,
    check_samples,
    measure_scatter,
    take_points,
)
from threedfs.io.oriented_points import read_oriented_points
from threedfs.io.volumes import Volume, read_support, read_volume, write_volume
from threedfs.job import Job
from threedfs.locate.height import height_above, known_above, least_height
from threedfs.params.deform import DeformParams
from threedfs.params.rules import make_rule


def run(
    *,
    field: Path,
    support: Path,
    cloud: Path,
    volume: Path,
    clearance: float,
    noise_clearance: float,
    params: DeformParams,
    job: Job,
) -> None:
    """Read the fused field and the points; write the corrected field, the fused one if points are switched off.

    Solids count from a height over the plane on: `clearance` voxels, or `noise_clearance` standard deviations of the
    support surface from its plane.
    """
    fused = read_volume(field)
    points, engine = read_oriented_points(cloud)
    sdf = fused.sdf
    if engine == "off":
        job.progress.note("no surface points (densify.points is off): the field stays as it is")
    else:
        samples = take_points(
            points,
            fused.sdf,
            fused.seen,
            fused.grid,
            reach=params.reach,
            min_cosine=params.min_cosine,
            full_sightings=params.full_sightings,
        )
        place = read_support(support)
        check_samples(samples, place.box.centre, place.plane)
        if params.cell > 0:
            scatter = measure_scatter(samples, fused.sdf, fused.grid)
            belief = believe_scattered(scatter, params.scatter)
            job.progress.note(f"points scatter by {scatter:.2f} voxels and count {belief:.2f} times")
            samples = average_in_cells(samples, fused.grid, params.cell, belief)
        sdf = correct_zero_crossing(
            fused.sdf,
            fused.seen,
            fused.grid,
            samples,
            make_rule(CorrectionRule, params),
            np.random.default_rng(job.seed),
            job.progress.note,
        )
        if params.keep_apart:
            least = least_height(clearance, noise_clearance, fused.grid.spacing, place.figures["plane_noise"])
            above = known_above(fused.seen, height_above(place.plane, fused.grid), least)
            sdf = keep_apart(fused.sdf, sdf, above)
    write_volume(volume, Volume(fused.grid, sdf, fused.seen), job.header)
