"""Which frames have a mask that a person made."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from PIL import Image

from threedfs.errors import UserError
from threedfs.frames.picture import name_video_frame


def match_masks(stems: Iterable[str], names: Iterable[str], *, numbered: bool) -> dict[str, str]:
    """Find the frame of each mask: that of its name, or, in a video, that of its number.

    Parameters
    ----------
    stems : iterable of str
        Names of the mask files without ending.
    names : iterable of str
        Names of the frames.
    numbered : bool
        Whether the frames are those of a video: then ``10``, ``0010`` and ``000010`` all mean frame 10.

    Returns
    -------
    dict of str to str
        Frame name to mask stem, in the order of the stems; masks without a frame are left out.
    """
    known = set(names)
    matches = {}
    for stem in sorted(stems):
        name = name_video_frame(int(stem)) if numbered and stem.isascii() and stem.isdigit() else stem
        if name in known:
            matches[name] = stem
    return matches


def find_masks(folder: Path, names: Iterable[str], *, numbered: bool) -> dict[str, Path]:
    """Find the mask file of every frame that has one.

    Raises
    ------
    UserError
        If the folder is missing, or no mask in it belongs to a frame.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise UserError(f"{folder}: expected a folder of masks, found none; check the path in the configuration.")
    files = {file.stem: file for file in sorted(folder.glob("*.png")) if not file.name.startswith(".")}
    matches = match_masks(files, names, numbered=numbered)
    if not matches:
        example = "000010.png or 10.png for frame 10" if numbered else "the photo's name with the ending png"
        raise UserError(
            f"{folder}: expected masks named after frames ({example}), got {len(files)} png files none of which "
            "belongs to a frame."
        )
    return {name: files[stem] for name, stem in matches.items()}


def check_mask_sizes(masks: Mapping[str, Path], shape: tuple[int, int]) -> None:
    """Check that masks have the size of the source frames, (rows, columns), reading only their headers.

    Raises
    ------
    UserError
        If one differs or is no image.
    """
    for file in masks.values():
        try:
            with Image.open(file) as image:
                columns, rows = image.size
        except (OSError, ValueError, SyntaxError) as fault:
            raise UserError(f"{file}: expected a mask image, got a file that cannot be read ({fault}).") from fault
        if (rows, columns) != tuple(shape):
            raise UserError(
                f"{file}: expected a mask of the size of the source frames, {shape[1]}x{shape[0]} pixels, got "
                f"{columns}x{rows}; masks are never resized."
            )
