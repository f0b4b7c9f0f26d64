"""Read a folder of photos, upright, past damaged files."""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from PIL import Image, ImageOps

from threedfs.errors import UserError
from threedfs.frames.picture import Picture
from threedfs.progress import Progress

HEIF_SUFFIXES = (".heic", ".heif")
PHOTO_SUFFIXES = (".jpg", ".jpeg", ".png", ".tif", ".tiff", ".bmp", ".webp", *HEIF_SUFFIXES)
_EXIF_ORIENTATION = 274
_LONGEST_NAME = 150  # bytes: results add marks and endings to it
_NAME = re.compile(r"[^{}\x00-\x1f\x7f]+")  # braces are wildcards of the workflow
_TURNED = (5, 6, 7, 8)  # EXIF orientations that swap rows and columns
_DEPTH_MODES = ("I", "F")  # Pillow's modes of more than 8 bits a channel
_FAULTS = (OSError, ValueError, SyntaxError, Image.DecompressionBombError)  # what Pillow raises for damaged files


@dataclass(frozen=True)
class Photos:
    """The photos of a folder that have the size most of them have, sorted by name.

    Attributes
    ----------
    path : Path
    files : tuple of Path
    shape : tuple of int
        (rows, columns), upright.
    unreadable : int
        Files of the folder left out because they are no whole image.
    """

    path: Path
    files: tuple[Path, ...]
    shape: tuple[int, int]
    unreadable: int

    ordered = False

    @property
    def names(self) -> tuple[str, ...]:
        """Stems of the files."""
        return tuple(file.stem for file in self.files)

    def pictures(self) -> Iterator[Picture]:
        """Yield every photo."""
        for index, file in enumerate(self.files):
            yield Picture(file.stem, index, float("nan"), partial(_load, file))


def scan_photos(folder: Path, progress: Progress) -> Photos:
    """List the photos of a folder, reading only their headers; tell which are left out and why.

    Raises
    ------
    UserError
        If there is no photo, or two files would give one frame name.
    """
    files = sorted(
        file
        for file in folder.iterdir()
        if file.is_file() and file.suffix.lower() in PHOTO_SUFFIXES and not file.name.startswith(".")
    )
    if any(file.suffix.lower() in HEIF_SUFFIXES for file in files):
        _learn_heif(folder)
    shapes = {}
    unreadable, depth_maps = 0, 0
    for file in files:
        try:
            mode, shape = _peek(file)
        except _FAULTS as fault:
            unreadable += 1
            progress.note(f"{file}: left out, it cannot be read ({fault})")
            continue
        if mode.startswith(_DEPTH_MODES):
            depth_maps += 1
        else:
            shapes[file] = shape
    if depth_maps:
        progress.note(f"{folder}: {depth_maps} files left out, 16-bit or real-valued grey like depth maps")
    readable = list(shapes)
    if not readable:
        if depth_maps:
            raise UserError(
                f"{folder}: expected photos with 8 bits a channel, got {depth_maps} files of 16-bit or real-valued "
                f"grey, like depth maps{f', and {unreadable} that cannot be read' if unreadable else ''}; convert them "
                "to 8 bits, or give the folder of the photos."
            )
        found = f"in which none of {len(files)} such files can be read" if files else "without such files"
        raise UserError(
            f"{folder}: expected a video or a folder of photos ({', '.join(s[1:] for s in PHOTO_SUFFIXES)}), got a "
            f"folder {found}{_name_others(folder)}."
        )
    # The first in order of name wins a draw, so that the choice does not depend on the file system.
    shape = Counter(shapes[file] for file in readable).most_common(1)[0][0]
    for file in readable:
        if shapes[file] != shape:
            progress.note(f"{file}: left out, {_say(shapes[file])}, while most photos are {_say(shape)}")
    kept = tuple(file for file in readable if shapes[file] == shape)
    for file in kept:
        if not _NAME.fullmatch(file.stem) or len(os.fsencode(file.stem)) > _LONGEST_NAME:
            raise UserError(
                f"{folder}: expected photos whose names can name results, got {file.name[:60]!r}; rename it to at most "
                f"{_LONGEST_NAME} letters without braces and line breaks."
            )
    twice = [name for name, count in Counter(file.stem for file in kept).items() if count > 1]
    if twice:
        raise UserError(
            f"{folder}: expected one photo of each name, got several named {twice[0]!r} that differ only in their "
            "ending; remove one."
        )
    return Photos(folder, kept, shape, unreadable)


def _peek(file):
    """Return the pixel mode and upright (rows, columns) of a photo from its header."""
    with Image.open(file) as image:
        columns, rows = image.size
        turned = image.getexif().get(_EXIF_ORIENTATION) in _TURNED
        return image.mode, (columns, rows) if turned else (rows, columns)


def _learn_heif(folder: Path) -> None:
    """Teach Pillow the format of phones; it is loaded only where there are such files."""
    try:
        from pillow_heif import register_heif_opener
    except ImportError as fault:
        raise UserError(
            f"{folder}: expected the package pillow-heif to read its HEIC photos, found none; run make setup, or "
            "convert them to jpg."
        ) from fault
    register_heif_opener(thumbnails=False)


def _load(file):
    try:
        with Image.open(file) as image:
            return np.array(ImageOps.exif_transpose(image).convert("RGB"))
    except _FAULTS:
        return None


def _name_others(folder: Path) -> str:
    """Name the endings of the files in a folder, and what to do about those of a phone."""
    endings = sorted({file.suffix.lower()[1:] for file in folder.iterdir() if file.is_file() and file.suffix})
    hint = "; convert them to jpg" if {"avif", "dng"} & set(endings) else ""
    return f"; it has files that end in {', '.join(endings)}{hint}" if endings else ""


def _say(shape):
    return f"{shape[1]}x{shape[0]} pixels"
