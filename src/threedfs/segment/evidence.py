"""What the images and the fused field give to the joint segmentation."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from threedfs.segment.color_model import TableMatch, lab_from_rgb
from threedfs.segment.initialise import UNDECIDED
from threedfs.segment.superpixels import Superpixels
from threedfs.types import View, VoxelGrid


@dataclass(frozen=True)
class ImageEvidence:
    """One keyframe.

    Attributes
    ----------
    view : View
    image : (H, W, 3) uint8
        RGB.
    superpixels : Superpixels
    decided : (count,) uint8
        Fixed labels, `UNDECIDED` in the band.
    first : (count,) uint8
        First labels of all.
    outside : (count,) float64
        Share of each superpixel's pixels whose depth lies outside the object's box (Eq. 22). Differs from the paper:
        there it is the region of interest, which holds much of the support too, as does
        `roi: grid` on the region's grid.
    pair_weight : (P,) float32
        Cost of different labels at the superpixels' pairs.
    link_pairs : (M, 2) int64
        Superpixel and flat index of a voxel that it shows.
    link_weight : (M,) float32
    silhouette_reach : float
        Pixels to both sides of the voxels' outline over which their silhouette is soft.
    table : TableMatch or None
        How the support surface would look at each pixel.
    """

    view: View
    image: np.ndarray
    superpixels: Superpixels
    decided: np.ndarray
    first: np.ndarray
    outside: np.ndarray
    pair_weight: np.ndarray
    link_pairs: np.ndarray
    link_weight: np.ndarray
    silhouette_reach: float = 0.0
    table: TableMatch | None = None

    @property
    def is_open(self) -> np.ndarray:
        """(count,) bool, superpixels in the band."""
        return self.decided == UNDECIDED

    @cached_property
    def band(self) -> tuple[np.ndarray, np.ndarray, TableMatch | None]:
        """Superpixel (N,), Lab colour (N, 3) float32 and table (N) of each pixel in the band."""
        index = self.superpixels.index
        inside = np.append(self.is_open, False)[index]
        return index[inside], lab_from_rgb(self.image[inside]), self.table and self.table.at(inside)


@dataclass(frozen=True)
class VoxelEvidence:
    """The fused field on its grid.

    Attributes
    ----------
    grid : VoxelGrid
    sdf : (nx, ny, nz) float32
    normalised : (nx, ny, nz) float32
        Normalised height above the support plane.
    fixed : (nx, ny, nz) uint8
        Fixed labels, `UNDECIDED` at open voxels.
    first : (nx, ny, nz) uint8
        First labels of all.
    """

    grid: VoxelGrid
    sdf: np.ndarray
    normalised: np.ndarray
    fixed: np.ndarray
    first: np.ndarray

    @property
    def is_open(self) -> np.ndarray:
        """(nx, ny, nz) bool."""
        return self.fixed == UNDECIDED
