"""Masks that a person made: which images cannot be one."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import cv2
import numpy as np

from threedfs.errors import UserError
from threedfs.io.images import read_mask

_WHITE = 127
"""Level above which a pixel is the object's, of 255; as `read_mask` has it."""
_BETWEEN = (32, 223)
_MOST_BETWEEN = 0.25
"""Share of greys from which an image is a photograph; soft borders of masks have a few per cent."""
_BORDER = 0.9


def read_true_mask(path: Path) -> np.ndarray:
    """Read a mask (H, W) bool that a result is measured against; it may be empty, where the object is out of view.

    Raises
    ------
    UserError
        If the file cannot be decoded, is white all over, is a photograph, or has other levels than black and white:
        of a mask with the levels 0 and 1 nothing would be left.
    """
    mask = read_mask(path)
    if mask.all():
        raise UserError(
            f"{path}: expected a white object on black, got white all over; draw the object, or remove this mask."
        )
    levels = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE | cv2.IMREAD_ANYDEPTH)
    if not mask.any() and levels.any():
        deep = f" of {np.iinfo(levels.dtype).max}" if levels.dtype != np.uint8 else ""
        raise UserError(
            f"{path}: expected a white object (level 255) on black, got levels up to {levels.max()}{deep} only; "
            "multiply them, masks with levels 0 and 1 by 255."
        )
    grey = np.count_nonzero((levels > _BETWEEN[0]) & (levels < _BETWEEN[1])) if levels.dtype == np.uint8 else 0
    if grey > _MOST_BETWEEN * levels.size:
        raise UserError(
            f"{path}: expected a white object on black, got an image of which {grey / levels.size:.0%} is grey; is it "
            "a photograph?"
        )
    return mask


def check_true_masks(paths: Iterable[Path], what: str, enough: int | None = None) -> None:
    """Check what masks show, together.

    Parameters
    ----------
    paths : iterable of Path
        Of files.
    what : str
        Name of their folder in the message.
    enough : int, optional
        Masks with an object after which the rest are not looked at.

    Raises
    ------
    UserError
        As `read_true_mask`, or if none shows an object, or most look inverted.
    """
    empty, shown, inverted = 0, 0, 0
    for path in paths:
        mask = read_true_mask(path)
        if mask.any():
            shown, inverted = shown + 1, inverted + surrounds(mask)
        else:
            empty += 1
        if shown == enough:
            break
    if empty and not shown:
        raise UserError(
            f"{what}: expected a white object on black in at least one mask, got {empty} that are black all over; a "
            "black mask says that the object is out of view."
        )
    if 2 * inverted > shown:
        raise UserError(
            f"{what}: expected a white object on black, got {inverted} of {shown} masks that are white along the "
            "border of the image and black within; invert them."
        )


def surrounds(mask: np.ndarray) -> bool:
    """Say whether a mask (H, W) bool is white along the border of the image and not within, as an inverted one is.

    Examples
    --------
    >>> mask = np.zeros((9, 9), bool)
    >>> mask[3:6, 3:6] = True
    >>> surrounds(mask), surrounds(~mask)
    (False, True)
    """
    border = np.concatenate([mask[0], mask[-1], mask[:, 0], mask[:, -1]])
    return bool(border.mean() >= _BORDER and mask[1:-1, 1:-1].mean() < border.mean())
