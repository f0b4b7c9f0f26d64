"""Tiny sources made on the spot."""

from __future__ import annotations

import io
from fractions import Fraction
from types import SimpleNamespace

import av
import numpy as np
import pytest

from threedfs.job import Job
from threedfs.progress import Progress

ROWS, COLUMNS = 96, 160
TICK = Fraction(1, 600)


@pytest.fixture
def log():
    """What the job told."""
    return io.StringIO()


@pytest.fixture
def job(log):
    return Job(Progress("test", log))


def draw_frame(index):
    """Draw a frame (96, 160, 3): red upper left, green lower right, texture, and a patch of blue 4 x number."""
    image = np.random.default_rng(7).integers(0, 60, (ROWS // 8, COLUMNS // 8, 3), dtype=np.uint8)
    image = np.kron(image, np.ones((8, 8, 1), np.uint8))
    image[:32, :48] = (255, 0, 0)
    image[-32:, -48:] = (0, 255, 0)
    image[32:64, 48:112] = (40, 40, 4 * (index % 60))
    return image


def read_number(image):
    """Read the number of a drawn frame, give or take a half by compression."""
    rows, columns = image.shape[:2]
    return image[rows // 2 - 4 : rows // 2 + 4, columns // 2 - 4 : columns // 2 + 4, 2].mean() / 4


def find_corners(image):
    """Name the corners of an image that are red and green."""
    last = {"upper left": (8, 8), "upper right": (8, -8), "lower left": (-8, 8), "lower right": (-8, -8)}
    found = {}
    for corner, (row, column) in last.items():
        red, green, _ = image[row, column].astype(int)
        if red > 180 and green < 80:
            found["red"] = corner
        if green > 180 and red < 80:
            found["green"] = corner
    return found


@pytest.fixture
def drawn():
    """How frames are drawn and read."""
    return SimpleNamespace(draw=draw_frame, number=read_number, corners=find_corners, shape=(ROWS, COLUMNS))


@pytest.fixture
def make_video():
    """Return a function that encodes drawn frames, at given times (seconds) or 30 a second."""

    def make(path, count=20, codec="libx264", rotation=0, mirrored=False, times=None, draw=draw_frame):
        with av.open(str(path), "w", options={"movflags": "faststart"}) as container:
            stream = container.add_stream(codec, rate=30)
            stream.height, stream.width = draw(0).shape[:2]
            stream.pix_fmt = "yuv420p"
            stream.codec_context.time_base = TICK
            stream.codec_context.gop_size = 5
            silent = {"x265-params": "log-level=none"} if codec == "libx265" else {}
            stream.codec_context.options = {"crf": "12"} | silent
            if rotation or mirrored:
                stream.set_display_rotation(rotation, hflip=mirrored)
            container.start_encoding()
            for index in range(count):
                frame = av.VideoFrame.from_ndarray(draw(index), format="rgb24")
                frame.pts = index * 20 if times is None else round(times[index] * 600)
                frame.time_base = TICK
                container.mux(stream.encode(frame))
            container.mux(stream.encode())
        return path

    return make
