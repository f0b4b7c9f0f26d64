"""Which frames have a true depth image, told by the names of the files alone."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from threedfs.errors import UserError

_DEPTH_OF_PHOTO = {".depth.png": ".color", "-depth.png": "-color"}
"""How a depth image's name ends, and the end of the stem of its photo that is left out before that."""


def match_depth_images(folder: Path, names: Iterable[str]) -> dict[str, Path]:
    """Find the depth image of every frame that has one.

    That is NAME.depth.png, for a photo NAME.color too; or NAME-depth.png for a photo NAME-color.
    """
    files = [
        (name, Path(folder) / f"{name.removesuffix(photo)}{depth}")
        for name in names
        for depth, photo in _DEPTH_OF_PHOTO.items()
    ]
    return {name: file for name, file in files if file.is_file()}


def find_depth_images(folder: Path, names: Iterable[str]) -> dict[str, Path]:
    """Find the depth image of every frame that has one, as `match_depth_images` does.

    Raises
    ------
    UserError
        If no depth image in the folder belongs to a frame.
    """
    found = match_depth_images(folder, names)
    if not found:
        count = len(list(Path(folder).glob("*depth.png")))
        raise UserError(
            f"{folder}: expected depth images named after frames (NAME.depth.png, or NAME-depth.png for a photo "
            f"NAME-color), got {count} of which none belongs to a frame."
        )
    return found


def choose_spread(names: Sequence[str], count: int) -> list[str]:
    """Choose `count` names spread evenly from the first to the last, or all if there are not more; of one, the middle.

    Examples
    --------
    >>> choose_spread(["a", "b", "c", "d", "e"], 3)
    ['a', 'c', 'e']
    """
    if len(names) <= count:
        return list(names)
    if count == 1:
        return [names[len(names) // 2]]
    # Halves are rounded up, so that the choice does not depend on how a language rounds.
    return [names[(2 * number * (len(names) - 1) + count - 1) // (2 * (count - 1))] for number in range(count)]


def choose_with_depth(names: Iterable[str], folder: Path, count: int) -> list[str]:
    """Choose `count` frames spread evenly over those that have a true depth image; fewer if there are not so many."""
    return choose_spread(list(match_depth_images(folder, names)), count)
