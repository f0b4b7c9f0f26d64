"""Draw frames of rendered takes side by side, a row a take, to see what they show.

    python docs/make_contact_sheets.py results docs/pictures/tabletop12.jpg
    python docs/make_contact_sheets.py results sheet.jpg books teabox

Reads results/SEQUENCE/00_render/video.mp4 of the sequences named, or of all that are rendered.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import av
import cv2
import numpy as np
from make_pictures import write_title

COLUMNS, WIDTH = 8, 1440


def draw_row(video: Path, name: str) -> np.ndarray:
    """Return evenly spaced frames of a video side by side, (H, WIDTH, 3) RGB, with its name on the first."""
    with av.open(str(video)) as container:
        count = container.streams.video[0].frames
        wanted = set(np.linspace(0, count - 1, COLUMNS).round().astype(int).tolist())
        frames = enumerate(container.decode(video=0))
        images = [frame.to_ndarray(format="rgb24") for index, frame in frames if index in wanted]
    width = WIDTH // COLUMNS
    size = (width, round(images[0].shape[0] * width / images[0].shape[1]))
    row = np.hstack([cv2.resize(image, size, interpolation=cv2.INTER_AREA) for image in images])
    write_title(row, name)
    return row


def main(results: Path, picture: Path, names: Sequence[str]) -> None:
    """Draw one picture."""
    names = names or sorted(video.parents[1].name for video in results.glob("*/00_render/video.mp4"))
    sheet = np.vstack([draw_row(results / name / "00_render/video.mp4", name) for name in names])
    cv2.imwrite(str(picture), sheet[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, 72])


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3:])
