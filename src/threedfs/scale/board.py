"""The corners of a checkerboard under the same names in every frame."""

from __future__ import annotations

from collections.abc import Mapping

import cv2
import numpy as np

from threedfs.geometry.lens import Lens


def board_places(board: tuple[int, int]) -> np.ndarray:
    """Return where the inner corners lie, (columns * rows, 2) float64 in squares, row after row."""
    rows, columns = np.mgrid[: board[1], : board[0]]
    return np.stack([columns, rows], axis=-1).reshape(-1, 2).astype(np.float64)


def align_boards(
    corners: Mapping[str, np.ndarray],
    board: tuple[int, int],
    lenses: Mapping[str, Lens],
    cam_from_world: Mapping[str, np.ndarray],
) -> dict[str, np.ndarray]:
    """Bring the corners found in several frames into one order.

    A board looks alike when it is turned by half a circle, one with as many rows as columns by a quarter: the detector
    starts at either end. With known poses its axes tell, as they point the same way in the world.

    Parameters
    ----------
    corners : mapping of str to (columns * rows, 2) float64
        Pixels (u, v) by frame, row after row, starting at any end.
    board : tuple of int
        Inner corners along a row and a column.
    lenses : mapping of str to Lens
    cam_from_world : mapping of str to (4, 4) float64

    Returns
    -------
    dict of str to (columns * rows, 2) float64
        The same in one order.
    """
    places = board_places(board)
    solid = np.column_stack([places, np.zeros(len(places))])
    aligned: dict[str, np.ndarray] = {}
    first: np.ndarray | None = None
    for name, pixels in corners.items():
        ways = []
        for turned in _turn(pixels.reshape(board[1], board[0], 2)):
            found, turn, _ = cv2.solvePnP(
                solid, lenses[name].normalise(turned)[:, None], np.eye(3), None, flags=cv2.SOLVEPNP_IPPE
            )
            if found:
                ways.append((turned, cam_from_world[name][:3, :3].T @ cv2.Rodrigues(turn)[0]))
        if not ways:
            continue
        if first is None:
            aligned[name], first = ways[0]
        else:
            aligned[name] = max(ways, key=lambda way: float(np.sum(way[1][:, :2] * first[:, :2])))[0]
    return aligned


def _turn(grid: np.ndarray) -> list[np.ndarray]:
    """Return the orders of a grid of corners (rows, columns, 2) in which the board is seen from its front."""
    across, down = grid[0, -1] - grid[0, 0], grid[-1, 0] - grid[0, 0]
    if across[0] * down[1] - across[1] * down[0] < 0:
        grid = grid[:, ::-1]
    quarters = (0, 1, 2, 3) if grid.shape[0] == grid.shape[1] else (0, 2)
    return [np.ascontiguousarray(np.rot90(grid, quarter)).reshape(-1, 2) for quarter in quarters]
