"""Writing frames as an H.264 video with the same bytes for the same frames."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
from llvmlite.binding import get_host_cpu_features

# BT.601 luma weights of red, green, blue, as video of this size is understood.
_LUMA = np.array([0.299, 0.587, 0.114])


def write_video(path: Path, frames: Iterable[np.ndarray], rate: int | Fraction, quality: int) -> None:
    """Encode RGB frames (H, W, 3) uint8, of even size, as mp4.

    The bytes depend on the frames alone, but for processors without AVX2, which give others.

    Parameters
    ----------
    path : Path
    frames : iterable
        Consumed one at a time.
    rate : int or Fraction
        Frames per second.
    quality : int
        Constant rate factor of x264: 18 is nearly lossless, 28 is coarse.
    """
    with av.open(str(path), "w", format="mp4", options={"fflags": "+bitexact"}) as container:
        stream = container.add_stream("libx264", rate=rate)
        stream.pix_fmt = "yuv420p"
        stream.options = {
            "crf": str(quality),
            "preset": "slow",
            "threads": "1",
            "x264-params": f"asm={_instructions()}",
        }
        stream.codec_context.thread_count = 1
        for index, image in enumerate(frames):
            if index == 0:
                stream.height, stream.width = image.shape[:2]
            frame = av.VideoFrame.from_ndarray(to_yuv420(image), format="yuv420p")
            frame.pts, frame.time_base = index, Fraction(1, rate)
            container.mux(stream.encode(frame))
        container.mux(stream.encode())


def _instructions() -> str:
    """Name the instructions that x264 may use: those of AVX-512 give other bytes in one of some thirty runs."""
    return "AVX2" if get_host_cpu_features().get("avx2") else "0"


def to_yuv420(image: np.ndarray) -> np.ndarray:
    """Convert RGB (H, W, 3) uint8 to limited-range BT.601, planes Y, U, V stacked as (H * 3 / 2, W) uint8.

    The encoder's own conversion runs on several threads and does not always give the same bytes.
    """
    height, width = image.shape[:2]
    rgb = image.astype(np.float64)
    luma = rgb[..., 0] * _LUMA[0] + rgb[..., 1] * _LUMA[1] + rgb[..., 2] * _LUMA[2]
    blocks = [
        plane.reshape(height // 2, 2, width // 2, 2).mean(axis=(1, 3)) for plane in (luma, *np.moveaxis(rgb, 2, 0))
    ]
    mean_luma, red, _, blue = blocks
    planes = [
        16 + luma * (219 / 255),
        128 + (blue - mean_luma) * (112 / 255 / (1 - _LUMA[2])),
        128 + (red - mean_luma) * (112 / 255 / (1 - _LUMA[0])),
    ]
    return np.concatenate([np.rint(plane).astype(np.uint8).reshape(-1, width) for plane in planes])
