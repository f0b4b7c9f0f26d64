"""Make synthetic videos: `python -m threedfs.synthetic sample FOLDER`, `... take NAME FOLDER`."""

from __future__ import annotations

import argparse
import os
from collections.abc import Sequence
from pathlib import Path

from threedfs.errors import UserError
from threedfs.params.render import RenderParams
from threedfs.progress import Progress
from threedfs.synthetic.export import FilmFiles, write_film
from threedfs.synthetic.film import Film
from threedfs.synthetic.render import Renderer
from threedfs.synthetic.sample import MASK_STEP, QUALITY, sample_film
from threedfs.synthetic.takes import list_takes, make_take
from threedfs.types import View


def main(words: Sequence[str] | None = None) -> None:
    """Parse the command line and render."""
    parser = argparse.ArgumentParser(prog="python -m threedfs.synthetic", description="Render synthetic videos.")
    commands = parser.add_subparsers(dest="command", required=True)
    sample = commands.add_parser("sample", help="render the sample that the project ships")
    take = commands.add_parser("take", help="render a take of Tabletop-12, to look at it")
    take.add_argument("name", choices=list_takes(), help="which one")
    take.add_argument("--frames", type=int, default=RenderParams.frames, help="frames in its 8 s")
    take.add_argument("--width", type=int, default=RenderParams.width, help="width of the images, pixels")
    for command in (sample, take):
        command.add_argument("output", type=Path, help="folder to write video.mp4, cameras.json, mesh.ply, masks/ into")
        command.add_argument("--processes", type=int, default=os.cpu_count() or 1, help="how many processes render")
    arguments = parser.parse_args(words)
    if arguments.processes < 1:
        parser.error(f"--processes: expected at least 1, got {arguments.processes}.")
    if arguments.command == "take" and arguments.frames < 2:
        parser.error(f"--frames: expected at least 2, got {arguments.frames}.")
    if arguments.output.exists() and not arguments.output.is_dir():
        parser.error(f"{arguments.output}: expected a folder to write into, got a file; name another.")
    try:
        film, unseen, mask_step = _choose(arguments)
    except UserError as fault:
        parser.error(str(fault))
    write_film(
        FilmFiles.below(arguments.output, depth=arguments.command == "take"),
        film,
        Renderer(film.scene),
        unseen=unseen,
        mask_step=mask_step,
        quality=QUALITY,
        processes=arguments.processes,
        progress=Progress(arguments.command),
    )


def _choose(arguments: argparse.Namespace) -> tuple[Film, Sequence[View], int]:
    """Return the film, the views that it leaves out, and how many frames lie between two masks."""
    if arguments.command == "sample":
        return sample_film(), (), MASK_STEP
    params = RenderParams(frames=arguments.frames, width=arguments.width)
    take = make_take(arguments.name)
    unseen = take.unseen(params.width, params.unseen_views)
    return take.film(params.frames, params.width, params.samples), unseen, params.mask_step


if __name__ == "__main__":
    main()
