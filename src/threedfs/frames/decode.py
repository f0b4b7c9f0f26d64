"""From a source to working frames, one at a time."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from math import ceil
from pathlib import Path

from threedfs.errors import UserError
from threedfs.frames.photos import Photos, scan_photos
from threedfs.frames.scale import shrink, working_shape
from threedfs.frames.sharpness import measure_contrast, measure_sharpness
from threedfs.frames.video import Video, scan_video
from threedfs.io.frames import Frame
from threedfs.progress import Progress


def scan_source(path: Path, progress: Progress) -> Video | Photos:
    """Find out what a source holds without decoding it: a video file, or a folder of photos.

    Raises
    ------
    UserError
        If there is nothing at `path`, or it is neither.
    """
    path = Path(path)
    if path.is_dir():
        return scan_photos(path, progress)
    if not path.is_file():
        raise UserError(f"{path}: expected a video or a folder of photos, found no such file; check the path.")
    return scan_video(path)


def choose_step(count: int, max_frames: int) -> int:
    """Return the smallest step that leaves at most `max_frames` of `count` frames.

    Examples
    --------
    >>> choose_step(706, 150)
    5
    """
    return max(1, ceil(count / max_frames))


class FrameReader:
    """Reads the working frames of a source once, holding one at a time, and counts what it leaves out.

    Every `step`-th frame is taken, or, where that one is damaged or blank, the next good one; and every frame named
    in `keep`.

    Attributes
    ----------
    taken : int
        Frames yielded so far.
    skipped : int
        Frames of the source that could not be decoded.
    blank : int
        Frames left out because they show nothing.
    """

    def __init__(
        self,
        source: Video | Photos,
        progress: Progress,
        *,
        longest_side: int,
        step: int,
        keep: Collection[str] = (),
        blank_contrast: float = 0.0,
    ) -> None:
        self.source = source
        self.taken = 0
        self.blank = 0
        self.skipped = source.unreadable
        self._progress = progress
        self._shape = working_shape(source.shape, longest_side)
        self._step = step
        self._keep = frozenset(keep)
        self._blank_contrast = blank_contrast

    def __iter__(self) -> Iterator[Frame]:
        decoded, due = 0, 0
        total = len(self.source.names)
        for picture in self._progress.track(self.source.pictures(), "source frame", total):
            decoded += 1
            if picture.index < due and picture.name not in self._keep:
                continue
            image = picture.load()
            if image is None:
                decoded -= 1
                self._progress.note(f"{picture.name}: left out, it cannot be decoded")
                continue
            image = shrink(image, self._shape)
            if measure_contrast(image) < self._blank_contrast:
                self.blank += 1
                continue
            if picture.index >= due:
                due = (picture.index // self._step + 1) * self._step
            self.taken += 1
            yield Frame(picture.name, picture.index, picture.time, measure_sharpness(image), image)
        self.skipped += total - decoded


def check_enough(reader: FrameReader, min_frames: int) -> None:
    """Check, after the last frame, that enough were read to reconstruct anything.

    Raises
    ------
    UserError
        If fewer than `min_frames` were.
    """
    if reader.taken < min_frames:
        total = len(reader.source.names) + reader.source.unreadable
        raise UserError(
            f"{reader.source.path}: expected at least {min_frames} usable frames, got {reader.taken} "
            f"of {total} ({reader.blank} blank, {reader.skipped} that cannot be decoded); "
            f"{_advise(reader)}."
        )


def _advise(reader: FrameReader) -> str:
    if reader.skipped > max(reader.blank, reader.taken):
        return "copy the files from the camera again, or convert them"
    if reader.blank > reader.taken:
        return "the pictures show nothing: check that the lens was free and the light on"
    return "film the object for longer" if reader.source.ordered else "take more photos of the object"
