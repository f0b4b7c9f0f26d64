"""Tunnels a few voxels wide, which noise drills through thin parts, are closed; pits stay."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import distance_transform_edt, find_objects, label
from skimage.measure import euler_number

_PLUG = np.float32(-0.5)
"""Value of a voxel that closes a tunnel."""
_CORNERS = 3
"""Voxels of the solid hang together where they touch at a corner."""


def close_tunnels(field: np.ndarray, above: np.ndarray, width: float) -> np.ndarray:
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
    """
    solid = field < 0
    if width <= 0 or not solid.any():
        return field
    added = _close(solid, width / 2) & ~solid & above
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


def _close(solid: np.ndarray, radius: float) -> np.ndarray:
    """Return a solid (nx, ny, nz) bool closed by a ball: dilated by its radius in voxels, and eroded by as much."""
    margin = int(np.ceil(radius)) + 1
    grown = distance_transform_edt(~np.pad(solid, margin)) <= radius
    closed = distance_transform_edt(grown) > radius
    inner = slice(margin, -margin)
    return closed[inner, inner, inner]
