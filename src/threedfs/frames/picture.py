"""One image of a source, before it is scaled."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Picture:
    """An image that a source offers; its pixels are made only when asked for.

    Attributes
    ----------
    name : str
        Six-digit index of the video frame, or the stem of the photo.
    index : int
        Number of the video frame, or rank among the photos.
    time : float
        Seconds from the start; NaN for photos.
    load : callable
        Returns the upright (H, W, 3) uint8 RGB image, or None if it cannot be decoded.
    """

    name: str
    index: int
    time: float
    load: Callable[[], np.ndarray | None]


def name_video_frame(index: int) -> str:
    """Name a video frame by its number, so that names sort like numbers.

    Examples
    --------
    >>> name_video_frame(10)
    '000010'
    """
    return f"{index:06d}"
