"""A mesh with a picture on it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from threedfs.types import Mesh


@dataclass(frozen=True)
class TexturedMesh:
    """A mesh with a picture on it.

    Attributes
    ----------
    mesh : Mesh
    corners : (F, 3, 2) float64
        Where each corner of each face lies in the picture, (column, row), whole numbers at texels' centres.
    image : (H, W, 3) uint8 RGB
    """

    mesh: Mesh
    corners: np.ndarray
    image: np.ndarray
