"""Pictures of the painted mesh against the photographs that it was not painted from."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from threedfs.evaluate.figures import Figure, photo_figures
from threedfs.evaluate.photo_error import measure_photo
from threedfs.evaluate.scores import Metric
from threedfs.evaluate.surface import SurfaceDistance, sample_surface
from threedfs.io.crops import read_crops
from threedfs.io.keyframes import read_views
from threedfs.io.meshes import read_mesh
from threedfs.io.metrics import write_metrics
from threedfs.io.texture import read_texture
from threedfs.io.textured_meshes import read_textured_obj
from threedfs.job import Job
from threedfs.params.photographs import PhotographsParams
from threedfs.texture.photograph import photograph_texture, photograph_vertices
from threedfs.texture.vertices import color_vertices, sample_vertices
from threedfs.types import Mesh


def run(
    *,
    mesh: Path,
    textured: Path,
    keyframes: Path,
    crops: Path,
    metrics: Path,
    dataset: str,
    sequence: str,
    method: str,
    params: PhotographsParams,
    job: Job,
) -> None:
    """Photograph the painted mesh from where the held-out photographs were taken; write the figures.

    Beside it, for comparison, the same mesh with colours at its vertices, of the photographs that it was painted from.
    Photographs that show next to nothing of the object do not count.
    """
    painted, record = read_textured_obj(textured / "mesh.obj"), read_texture(textured / "painted.json")
    images = read_crops(crops)
    views = read_views(keyframes)
    samples = sample_vertices(
        painted.mesh, [views[name] for name in record.painted_from], images.image, images.valid_of
    )
    takers = [
        photograph_texture(painted),
        photograph_vertices(painted.mesh, color_vertices(painted.mesh, samples).astype(np.float64)),
    ]
    rows = []
    for name in job.progress.track(record.held_out, "photograph"):
        photo, valid = images.image(name), images.valid_of(name)
        pictures = [taker.take(views[name]) for taker in takers]
        where = pictures[0][1] & valid
        if where.sum() >= params.least_pixels:
            rows.append([figure for picture, _ in pictures for figure in measure_photo(picture, photo, where)])
    figures = [
        *photo_figures(np.array(rows).reshape(-1, 4)),
        _measure_deviation(read_mesh(mesh), painted.mesh, params, job),
    ]
    write_metrics(metrics, [Metric(item.name, item.value, item.unit, dataset, sequence, method) for item in figures])


def _measure_deviation(mesh: Mesh, simple: Mesh, params: PhotographsParams, job: Job) -> Figure:
    """Return the 99th percentile distance of points on the mesh from its simplified form."""
    generator = np.random.default_rng(job.seed)
    points, _ = sample_surface(mesh, params.surface_samples, generator)
    distance = SurfaceDistance(simple, *sample_surface(simple, params.surface_samples, generator))(points)
    diagonal = np.linalg.norm(np.ptp(mesh.vertices, axis=0))
    return Figure("texture_deviation", float(100 * np.percentile(distance, 99) / diagonal), "% of diagonal")
