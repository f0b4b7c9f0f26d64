"""Film a take of the synthetic data set, with its truth."""

from __future__ import annotations

from pathlib import Path

from threedfs.job import Job
from threedfs.params.render import RenderParams
from threedfs.synthetic.export import FilmFiles, write_film
from threedfs.synthetic.render import Renderer
from threedfs.synthetic.takes import make_take


def run(
    *,
    video: Path,
    cameras: Path,
    mesh: Path,
    masks: Path,
    depth: Path,
    take: str,
    params: RenderParams,
    job: Job,
) -> None:
    """Write the video of a take, and cameras, mesh, masks and depth images as its truth.

    Raises
    ------
    UserError
        If there is no such take.
    """
    made = make_take(take)
    film = made.film(params.frames, params.width, params.samples)
    job.progress.note(f"take {take}, object of {len(film.scene.solid.mesh.faces)} triangles")
    write_film(
        FilmFiles(video, cameras, mesh, masks, depth),
        film,
        Renderer(film.scene, params.shadow_rays, params.ambient_rays),
        unseen=made.unseen(params.width, params.unseen_views),
        mask_step=params.mask_step,
        quality=params.quality,
        processes=job.threads,
        progress=job.progress,
    )
