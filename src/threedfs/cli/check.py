"""`threedfs check`: whether a video or photos can be used, in seconds, before hours are spent."""

from __future__ import annotations

import io
import itertools
from argparse import Namespace
from pathlib import Path

from threedfs.footage.look import look_at_frame
from threedfs.footage.motion import measure_step
from threedfs.footage.verdict import BAD, GOOD, conclude, judge_film
from threedfs.frames.decode import FrameReader, choose_step, scan_source
from threedfs.frames.video import Video, describe_stream
from threedfs.progress import Progress

_LOOKS = 40
_LONGEST_SIDE = 640


def check(arguments: Namespace) -> int:
    """Say of each source what is good and what is not; return 0 if all can be used, else 1.

    Raises
    ------
    UserError
        If one is no video and no folder of photos.
    """
    return max([_check(Path(source).expanduser()) for source in arguments.video])


def _check(path: Path) -> int:
    notes = io.StringIO()
    source = scan_source(path, Progress("check", notes, interval=float("inf")))
    count = len(source.names)
    total = count + source.unreadable
    reader = FrameReader(source, Progress("check", notes), longest_side=_LONGEST_SIDE, step=choose_step(count, _LOOKS))
    looks, shape = [], (0, 0)
    for frame in reader:
        looks.append(look_at_frame(frame.image))
        shape = frame.image.shape[:2]
    steps = [measure_step(*pair, shape) for pair in itertools.pairwise(looks)]
    seconds = source.seconds if isinstance(source, Video) else None
    about = describe_stream(path) if isinstance(source, Video) else f"{total} photos"
    print(f"{path}: {source.shape[1]}x{source.shape[0]} pixels, {about}")
    if reader.skipped:
        print(f"       {reader.skipped} of {total} cannot be decoded and are left out")
    opinions = judge_film(looks, steps, seconds=seconds, frames=total - reader.skipped)
    for opinion in opinions:
        print(f"  {opinion.grade:5} {opinion.what}: {opinion.value}")
        if opinion.grade != GOOD:
            print(f"        {opinion.advice}")
    print(f"verdict: {conclude(opinions)}")
    return int(any(opinion.grade == BAD for opinion in opinions))
