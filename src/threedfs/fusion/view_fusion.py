"""Views that vote on a field one after the other."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable
from typing import Any

import numpy as np

from threedfs.read_ahead import map_ahead
from threedfs.threads import use_threads
from threedfs.types import View, VoxelGrid


class ViewFusion(ABC):
    """Takes in the depth maps of views on a grid, holding a few at a time.

    Parameters
    ----------
    grid : VoxelGrid
    threads : int
        Cores used; the result does not depend on it.
    """

    def __init__(self, grid: VoxelGrid, threads: int) -> None:
        self.grid = grid
        self._threads = threads

    def add(self, *vote: Any) -> None:
        """Let one view vote on every voxel it sees; takes what `weigh` takes."""
        self._count(self.weigh(*vote))

    def add_all(self, votes: Iterable[tuple]) -> None:
        """Let views vote one after the other; what concerns one view alone is worked out ahead, by other threads.

        Parameters
        ----------
        votes : iterable of tuple
            Of each view what `weigh` takes.
        """
        for ballot in map_ahead(lambda vote: self.weigh(*vote), votes, threads=self._threads):
            self._count(ballot)

    def _count(self, ballot: tuple) -> None:
        use_threads(self._threads)
        self.count(*ballot)

    @abstractmethod
    def weigh(self, view: View, depth: np.ndarray) -> tuple:
        """Return what `count` takes of a view with a depth map (H, W), NaN where missing; changes nothing.

        Raises
        ------
        UserError
            If the map has not the shape of the view's images.
        """

    @abstractmethod
    def count(self, *ballot: Any) -> None:
        """Add the votes of one view to the field."""

    @abstractmethod
    def result(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the field (nx, ny, nz) float32, and by how many views (nx, ny, nz) uint8 it is made."""
