"""How the object, its background and the support surface look."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.segment.color_model import ColorModel
from threedfs.segment.table import TablePicture


@dataclass(frozen=True)
class Appearance:
    """What a segmentation has learnt that holds for any frame.

    Attributes
    ----------
    colors : ColorModel
    table : TablePicture or None
        None where it was not looked at.
    """

    colors: ColorModel
    table: TablePicture | None
