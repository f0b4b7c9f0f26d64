"""Which connected piece of the interior is the object."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from threedfs.geometry.grid import voxel_index, world_from_index
from threedfs.types import VoxelGrid


@dataclass(frozen=True)
class Component:
    """A connected set of voxels.

    Attributes
    ----------
    voxels : (nx, ny, nz) bool
    support : int
        Number of its voxels, and of their neighbours, that hold a semi-dense point.
    rivals : int
        Number of other components that any point supports.
    """

    voxels: np.ndarray
    support: int
    rivals: int


def mark_points(grid: VoxelGrid, points: np.ndarray, holds: np.ndarray) -> None:
    """Set `holds` (nx, ny, nz) bool, in place, at the voxels that contain any of the world points (N, 3)."""
    index, _ = voxel_index(grid, points)
    holds[tuple(index.T)] = True


def choose_component(
    interior: np.ndarray,
    grid: VoxelGrid,
    holds: np.ndarray,
    fixation: np.ndarray,
    *,
    reach: float,
    bridge: int = 0,
) -> Component | None:
    """Choose the component of the interior that points and views speak for.

    A component (6-connected) scores by the number of voxels on it, or beside it, that hold points, falling off with
    its distance from the fixation point, and quartered for each face of the grid that it touches.

    Differs from the paper: Secs. 3.4.2 and 3.5 take the largest one, which in a wide region is the space behind walls.

    Parameters
    ----------
    interior : (nx, ny, nz) bool
    grid : VoxelGrid
    holds : (nx, ny, nz) bool
        Voxels that hold points (`mark_points`).
    fixation : (3,) float64
        What all views look at.
    reach : float
        Standard deviation of the fall-off, scene units.
    bridge : int
        Pieces up to twice so many voxels apart count as one component.

    Returns
    -------
    Component or None
        None where no component is supported by any point.
    """
    joined = ndimage.binary_dilation(interior, iterations=bridge) if bridge else interior
    labels, count = ndimage.label(joined)
    labels[~interior] = 0
    support = _count_support(labels, holds, count)
    supported = np.flatnonzero(support) + 1
    if len(supported) == 0:
        return None
    boxes = ndimage.find_objects(labels)
    scores = [
        support[label - 1]
        * np.exp(-0.5 * (_distance(labels, boxes[label - 1], label, grid, fixation) / reach) ** 2)
        * 0.25 ** _touched_faces(boxes[label - 1], labels.shape)
        for label in supported
    ]
    best = supported[int(np.argmax(scores))]
    return Component(labels == best, int(support[best - 1]), len(supported) - 1)


def choose_standing_component(
    interior: np.ndarray,
    height: np.ndarray,
    grid: VoxelGrid,
    holds: np.ndarray,
    fixation: np.ndarray,
    *,
    clearance: float,
    doublings: int,
    reach: float,
    bridge: int = 0,
) -> Component | None:
    """Choose the component above the support, raising the clearance while the chosen one reaches the grid's border.

    A support without texture comes out uneven, and what sticks out of the clearance may join the object with the
    walls around. Where no clearance parts them, the choice at the first one stands.

    Parameters
    ----------
    interior, holds : (nx, ny, nz) bool
    height : (nx, ny, nz) float32
        Above the support plane, scene units.
    grid, fixation, reach, bridge
        See `choose_component`.
    clearance : float
        First height from which voxels may belong to the object, scene units.
    doublings : int
        Times that it is doubled at most.

    Returns
    -------
    Component or None
        None where no component above the first clearance is supported by any point.
    """
    first = None
    for attempt in range(doublings + 1):
        high = height > clearance * 2**attempt
        chosen = choose_component(interior & high, grid, holds & high, fixation, reach=reach, bridge=bridge)
        if chosen is None:
            return first
        if not _touches_border(chosen.voxels):
            return chosen
        first = first or chosen
    return first


def _touches_border(voxels: np.ndarray) -> bool:
    return any(bool(np.take(voxels, end, axis=axis).any()) for axis in range(3) for end in (0, -1))


def _count_support(labels: np.ndarray, holds: np.ndarray, count: int) -> np.ndarray:
    """Count the voxels with points at or beside each label 1..count."""
    padded = np.pad(labels, 1)
    index = np.argwhere(holds)
    own = labels[tuple(index.T)]
    beside = np.zeros_like(own)
    for offset in np.ndindex(3, 3, 3):
        beside = np.maximum(beside, padded[tuple((index + offset).T)])
    return np.bincount(np.where(own > 0, own, beside), minlength=count + 1)[1:]


def _distance(labels: np.ndarray, box: tuple[slice, ...], label: int, grid: VoxelGrid, point: np.ndarray) -> float:
    index = np.argwhere(labels[box] == label) + [part.start for part in box]
    return float(np.sqrt(((world_from_index(grid, index) - point) ** 2).sum(axis=1).min()))


def _touched_faces(box: tuple[slice, ...], shape: tuple[int, ...]) -> int:
    return sum((part.start == 0) + (part.stop == length) for part, length in zip(box, shape, strict=True))
