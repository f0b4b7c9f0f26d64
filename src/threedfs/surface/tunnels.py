"""Tunnels a few voxels wide, which noise drills, are closed; pits stay."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import find_objects, label
from skimage.measure import euler_number

from threedfs.geometry.near import find_near
from threedfs.surface.sky import rate_openness
from threedfs.types import VoxelGrid

_PLUG = np.float32(-0.5)
"""Value of a voxel that closes a tunnel."""
_CORNERS = 3
"""Voxels of the solid hang together where they touch at a corner."""
_HIDDEN = 0.05
"""Share of the sky below which a place is hidden inside the object."""


def close_tunnels(field: np.ndarray, above: np.ndarray, width: float, threads: int = 1) -> np.ndarray:
    """Return the field (nx, ny, nz) float32, negative inside, with narrow tunnels closed.

    Not in the paper. What a closing of the solid by a ball adds falls into pieces. A piece whose addition raises the
    solid's Euler characteristic closes a tunnel, and is kept; others only level a groove or a pit.

    Parameters
    ----------
    field : (nx, ny, nz) float32
    above : (nx, ny, nz) bool
        Voxels that may become solid.
    width : float
        Of the widest tunnel that is closed, voxels.
    threads : int
        Changes no result.
    """
    solid = field < 0
    if width <= 0 or not solid.any():
        return field
    return _plug_tunnels(field, solid, _closed_by_ball(solid, above & ~solid, width / 2, threads))


def close_hidden_tunnels(
    field: np.ndarray, above: np.ndarray, width: float, grid: VoxelGrid, up: np.ndarray, threads: int = 1
) -> np.ndarray:
    """Return the field (nx, ny, nz) float32, negative inside, with tunnels plugged where hardly any sky is seen.

    Not in the paper. A wider ball than that of `close_tunnels` would fill what lies between spines and folds, too. But
    these places are open to the sky, and the inside of a tunnel is not. The ends of the tunnel stay, as pits.

    Parameters
    ----------
    field : (nx, ny, nz) float32
    above : (nx, ny, nz) bool
        Voxels that may become solid. The others hide the sky.
    width : float
        Of the widest tunnel that is plugged, voxels.
    grid : VoxelGrid
    up : (3,) float64
        Unit normal of the support plane, world frame.
    threads : int
        Changes no result.
    """
    solid = field < 0
    if width <= 0 or not solid.any():
        return field
    added = _closed_by_ball(solid, above & ~solid, width / 2, threads)
    places = np.flatnonzero(added)
    shown = rate_openness(solid | ~above, places, grid, up, threads) >= _HIDDEN
    added.flat[places[shown]] = False
    return _plug_tunnels(field, solid, added)


def _plug_tunnels(field: np.ndarray, solid: np.ndarray, added: np.ndarray) -> np.ndarray:
    """Return the field with those pieces of `added` (nx, ny, nz) bool made solid that close a tunnel."""
    pieces, _ = label(added)
    padded, closed = np.pad(solid, 1), field.copy()
    for number, box in enumerate(find_objects(pieces), start=1):
        piece = pieces[box] == number
        around = padded[tuple(slice(part.start, part.stop + 2) for part in box)]
        filled = around.copy()
        filled[1:-1, 1:-1, 1:-1] |= piece
        if euler_number(filled, _CORNERS) > euler_number(around, _CORNERS):
            closed[box][piece] = _PLUG
    return closed


def _closed_by_ball(solid: np.ndarray, among: np.ndarray, radius: float, threads: int) -> np.ndarray:
    """Return the voxels of `among` (nx, ny, nz) bool that closing the solid with a ball of a radius in voxels adds."""
    margin = int(np.ceil(radius)) + 1
    padded = np.pad(solid, margin)
    grown = padded | find_near(padded, radius, ~padded, threads)
    added = grown & np.pad(among, margin)
    added &= ~find_near(~grown, radius, added, threads)
    inner = slice(margin, -margin)
    return added[inner, inner, inner]
