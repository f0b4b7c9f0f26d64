"""Decode a video frame by frame, upright, past damaged places."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import av
import numpy as np
from av.sidedata.sidedata import Type as SideDataType

from threedfs.errors import UserError
from threedfs.frames.hdr import TRANSFERS, tone_map
from threedfs.frames.picture import Picture, name_video_frame

_FULL_RANGE = 2  # as FFmpeg numbers ranges
_CODECS = {"h264": "H.264", "hevc": "HEVC", "av1": "AV1", "libdav1d": "AV1", "vp9": "VP9"}
_EXPECTED = "expected a video (mp4 or mov) or a folder of photos"
_PLAYLISTS = {"hls", "applehttp", "concat", "dash", "sdp", "imf"}  # their pictures lie in other files


@dataclass(frozen=True)
class Video:
    """What is known of a video before it is decoded.

    Attributes
    ----------
    path : Path
    timestamps : tuple of int
        Presentation times of all its frames, ascending, in the stream's time base: the rank of a frame's time is
        its number, also where frames before it could not be decoded.
    shape : tuple of int
        (rows, columns) of its first decodable frame, upright.
    time_base : float
        Seconds in a unit of these times.
    """

    path: Path
    timestamps: tuple[int, ...]
    shape: tuple[int, int]
    time_base: float

    ordered = True
    unreadable = 0

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all its frames, decodable or not."""
        return tuple(name_video_frame(index) for index in range(len(self.timestamps)))

    @property
    def seconds(self) -> float:
        """From the first frame to the last."""
        return (self.timestamps[-1] - self.timestamps[0]) * self.time_base

    def pictures(self) -> Iterator[Picture]:
        """Decode; yield every frame of the video's size in presentation order, leaving out those that fail."""
        last = -1
        with _opened(self.path) as (container, stream):
            for frame in _decode(container, stream):
                # Equal or missing times, which broken files have, must not give two frames one number.
                rank = last + 1 if frame.pts is None else bisect_left(self.timestamps, frame.pts)
                last = max(rank, last + 1)
                if last >= len(self.timestamps) or _upright_shape(frame) != self.shape:
                    continue
                seconds = (self.timestamps[last] - self.timestamps[0]) * self.time_base
                yield Picture(name_video_frame(last), last, seconds, partial(_upright_image, frame))


def scan_video(path: Path) -> Video:
    """Find the frames of a video and their size by reading its packets, decoding only as far as the first frame.

    Raises
    ------
    UserError
        If the file is empty, is no video, or no frame of it can be decoded.
    """
    if path.stat().st_size == 0:
        raise UserError(f"{path}: {_EXPECTED}, got an empty file; copy it again.")
    with _opened(path) as (container, stream):
        time_base = float(stream.time_base)
        timestamps = sorted(
            position if packet.pts is None else packet.pts
            for position, packet in enumerate(_packets(container, stream))
            if not packet.is_discard
        )
    with _opened(path) as (container, stream):
        first = next(_decode(container, stream), None)
        shape = None if first is None else _upright_shape(first)
    if shape is None:
        raise UserError(
            f"{path}: expected a video with frames, got {len(timestamps)} packets of which none can be decoded; "
            "copy or convert the file again."
        )
    return Video(path, tuple(timestamps), shape, time_base)


def describe_stream(path: Path) -> str:
    """Say in a few words how a video is made: codec, frames a second, bits, HDR, and whether it is turned."""
    with _opened(path) as (container, stream):
        context, rate = stream.codec_context, stream.average_rate
        words = [_CODECS.get(context.name, context.name)]
        if rate:
            words.append(f"{float(rate):.3g} frames a second")
        frame = next(_decode(container, stream), None)
        if frame is not None:
            if frame.color_trc in TRANSFERS:
                words.append(f"HDR ({TRANSFERS[frame.color_trc]}), brought to ordinary range")
            elif frame.format.components[0].bits > 8:
                words.append(f"{frame.format.components[0].bits} bits")
            if not np.array_equal(np.sign(_display_matrix(frame)), np.eye(2)):
                words.append("turned upright as its rotation flag says")
    return ", ".join(words)


@contextmanager
def _opened(path):
    try:
        container = av.open(f"file:{path}")  # else a name with a colon is taken for an address
    except (av.FFmpegError, OSError) as fault:
        raise UserError(f"{path}: {_EXPECTED}, got a file that cannot be opened as one ({_reason(fault)}).") from fault
    with container:
        # FFmpeg "plays" any text file as a terminal recording.
        if not container.streams.video or container.format.name == "tty":
            raise UserError(f"{path}: {_EXPECTED}, got a file without a video stream.")
        kinds = set(container.format.name.split(","))
        if kinds & _PLAYLISTS:
            raise UserError(
                f"{path}: {_EXPECTED}, got a list of other files ({container.format.name}); give the video."
            )
        if any(kind.endswith("_pipe") for kind in kinds):
            raise UserError(f"{path}: {_EXPECTED}, got a single picture; put all photos into a folder and give that.")
        stream = container.streams.video[0]
        if stream.codec_context is None:
            raise UserError(f"{path}: expected a video in H.264 or HEVC, got a codec that is not known; convert it.")
        # One thread: with several, what is concealed after damaged data depends on their timing.
        stream.codec_context.thread_count = 1
        yield container, stream


def _packets(container, stream):
    """Yield the stream's packets with data, up to the first place where the container is damaged."""
    packets = container.demux(stream)
    while True:
        try:
            packet = next(packets)
        except (StopIteration, av.FFmpegError):
            return
        if packet.size:
            yield packet


def _decode(container, stream):
    """Yield the frames that decode, past faults; those the decoder itself calls corrupt are left out."""
    for packet in _packets(container, stream):
        yield from _decode_packet(packet)
    yield from _decode_packet(None, stream)


def _decode_packet(packet, stream=None):
    try:
        frames = packet.decode() if packet is not None else stream.decode(None)
    except av.FFmpegError:
        return
    for frame in frames:
        if not frame.is_corrupt:
            yield frame


def _display_matrix(frame):
    """Return the 2x2 part that maps stored (x, y) rows to shown ones: (x', y') = (x, y) M."""
    for data in frame.side_data.keys():
        if data.type == SideDataType.DISPLAYMATRIX:
            return np.frombuffer(bytes(data), np.int32).reshape(3, 3)[:2, :2]
    return np.eye(2, dtype=np.int32)


def _upright_shape(frame):
    matrix = _display_matrix(frame)
    turned = abs(matrix[0, 1]) > abs(matrix[0, 0])
    return (frame.width, frame.height) if turned else (frame.height, frame.width)


def _upright_image(frame):
    if frame.color_trc in TRANSFERS:
        full_range = frame.color_range == _FULL_RANGE
        image = tone_map(frame.to_ndarray(format="yuv444p16le"), frame.color_trc, full_range=full_range)
    else:
        image = frame.to_ndarray(format="rgb24")
    return orient(image, _display_matrix(frame))


def orient(image: np.ndarray, shown_from_stored: np.ndarray) -> np.ndarray:
    """Turn an image (H, W, 3) as its display matrix says: by quarter turns, mirrored or not.

    Parameters
    ----------
    shown_from_stored : (2, 2) ndarray
        (x', y') = (x, y) M up to a positive factor; angles between quarter turns are taken to the nearest.
    """
    (xx, xy), (yx, yy) = shown_from_stored
    if abs(xy) > abs(xx):
        image, flip_columns, flip_rows = image.swapaxes(0, 1), yx < 0, xy < 0
    else:
        flip_columns, flip_rows = xx < 0, yy < 0
    image = image[:: -1 if flip_rows else 1, :: -1 if flip_columns else 1]
    return np.ascontiguousarray(image)


def _reason(fault):
    return getattr(fault, "strerror", None) or str(fault)
