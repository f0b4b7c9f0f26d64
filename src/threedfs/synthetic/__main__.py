"""Make synthetic videos: `python -m threedfs.synthetic sample OUTPUT_FOLDER`."""

from __future__ import annotations

import argparse
import os
from collections.abc import Sequence
from pathlib import Path

from threedfs.progress import Progress
from threedfs.synthetic.export import write_film
from threedfs.synthetic.sample import MASK_STEP, QUALITY, sample_film


def main(words: Sequence[str] | None = None) -> None:
    """Parse the command line and render."""
    parser = argparse.ArgumentParser(prog="python -m threedfs.synthetic", description="Render synthetic videos.")
    commands = parser.add_subparsers(dest="command", required=True)
    sample = commands.add_parser("sample", help="render the sample that the project ships")
    sample.add_argument("output", type=Path, help="folder to write video.mp4, cameras.json, mesh.ply and masks/ into")
    sample.add_argument("--processes", type=int, default=os.cpu_count() or 1, help="how many processes render")
    arguments = parser.parse_args(words)
    if arguments.processes < 1:
        parser.error(f"--processes: expected at least 1, got {arguments.processes}.")
    if arguments.output.exists() and not arguments.output.is_dir():
        parser.error(f"{arguments.output}: expected a folder to write into, got a file; name another.")
    write_film(arguments.output, sample_film(), MASK_STEP, QUALITY, arguments.processes, Progress("sample"))


if __name__ == "__main__":
    main()
