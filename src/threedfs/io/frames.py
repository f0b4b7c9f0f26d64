"""Frames: images of one size with name, source index, time and sharpness, read one at a time."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import zarr

from threedfs.io.arrays import open_arrays, writing_arrays
from threedfs.io.schema import Schema

FRAMES = Schema("threedfs/frames/1", "frames")


@dataclass(frozen=True)
class Frame:
    """One decoded image.

    Attributes
    ----------
    name : str
        Six-digit index of the video frame, or the stem of the photo.
    index : int
        Index in the source (video frame number, or rank among the photos).
    time : float
        Seconds from the start; NaN for photos.
    sharpness : float
        Larger is sharper; comparable within a sequence.
    image : (H, W, 3) uint8 RGB
    """

    name: str
    index: int
    time: float
    sharpness: float
    image: np.ndarray


@dataclass(frozen=True)
class FrameStore:
    """The frames of a sequence on disk.

    Attributes
    ----------
    names : tuple of str
    indices : (N,) int64
    times, sharpness : (N,) float64
    ordered : bool
        Whether neighbours in the list are neighbours in time (a video).
    skipped : int
        Source frames that could not be decoded.
    shape : tuple
        (H, W)
    source_shape : tuple
        (H, W) of the source before it was scaled to the working resolution.
    """

    names: tuple[str, ...]
    indices: np.ndarray
    times: np.ndarray
    sharpness: np.ndarray
    ordered: bool
    skipped: int
    shape: tuple[int, int]
    source_shape: tuple[int, int]
    images: zarr.Array

    def image(self, name: str) -> np.ndarray:
        """Read one image, (H, W, 3) uint8 RGB."""
        return np.asarray(self.images[self.names.index(name)])


def write_frames(
    path: Path,
    frames: Iterable[Frame],
    header: Mapping[str, Any],
    *,
    ordered: bool,
    source_shape: tuple[int, int],
    skipped: Any = 0,
) -> None:
    """Stream frames to an artifact; never more than one is held.

    Parameters
    ----------
    frames : iterable of Frame
    skipped : int or callable
        Frames that could not be decoded; a callable is asked after the last frame.
    """
    names, indices, times, sharpness = [], [], [], []
    with writing_arrays(path, FRAMES, header) as writer:
        for frame in frames:
            writer.append("images", frame.image, axes="frame, row, column, RGB")
            names.append(frame.name)
            indices.append(frame.index)
            times.append(frame.time)
            sharpness.append(frame.sharpness)
        writer.put("indices", np.array(indices, np.int64))
        writer.put("times", np.array(times, np.float64), unit="s")
        writer.put("sharpness", np.array(sharpness, np.float64))
        writer.attributes.update(
            names=names,
            ordered=ordered,
            source_shape=list(source_shape),
            skipped=int(skipped() if callable(skipped) else skipped),
        )


def read_frames(path: Path) -> FrameStore:
    """Open the frames of a sequence; images are read when asked for."""
    group = open_arrays(path, FRAMES)
    images = group["images"]
    return FrameStore(
        names=tuple(group.attrs["names"]),
        indices=np.asarray(group["indices"][...]),
        times=np.asarray(group["times"][...]),
        sharpness=np.asarray(group["sharpness"][...]),
        ordered=bool(group.attrs["ordered"]),
        skipped=int(group.attrs["skipped"]),
        shape=tuple(images.shape[1:3]),
        source_shape=tuple(group.attrs["source_shape"]),
        images=images,
    )
