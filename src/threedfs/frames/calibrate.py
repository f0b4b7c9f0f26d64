"""Focal length, centre and radial distortion from images of a checkerboard (Section 3.1)."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import contextmanager

import cv2
import numpy as np

from threedfs.errors import UserError
from threedfs.io.calibration import Calibration
from threedfs.types import Camera

_FEWEST_BOARDS = 3  # two give as many equations as unknowns and no check
_REFINED = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 100, 1e-4)
_SOLVED = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 200, 1e-12)


def find_board(image: np.ndarray, board: tuple[int, int], window: int) -> np.ndarray | None:
    """Find the inner corners of a checkerboard, to a fraction of a pixel.

    Parameters
    ----------
    image : (H, W, 3) uint8 RGB
    board : tuple of int
        Inner corners along a row and a column of the board.
    window : int
        Half side of the square in which a corner is refined, pixels.

    Returns
    -------
    (columns * rows, 2) float64 or None
        Pixels (u, v), row after row of the board; None where not all of it is found.
    """
    grey = cv2.cvtColor(image, cv2.COLOR_RGB2GRAY)
    flags = cv2.CALIB_CB_ADAPTIVE_THRESH + cv2.CALIB_CB_NORMALIZE_IMAGE
    found, corners = cv2.findChessboardCorners(grey, board, flags=flags)
    if not found:
        return None
    refined = cv2.cornerSubPix(grey, corners, (window, window), (-1, -1), _REFINED)
    return refined.reshape(-1, 2).astype(np.float64)


def calibrate(corners: Sequence[np.ndarray], board: tuple[int, int], shape: tuple[int, int]) -> Calibration:
    """Fit a camera with radial distortion (k1, k2) to the corners found in several images of a flat board.

    Tangential and higher radial terms are zero.

    Parameters
    ----------
    corners : sequence of (columns * rows, 2) float64
        As `find_board` gives them, one for each image.
    board : tuple of int
        Inner corners along a row and a column.
    shape : tuple of int
        (rows, columns) of the images.

    Raises
    ------
    UserError
        If there are fewer than three images.
    """
    if len(corners) < _FEWEST_BOARDS:
        raise UserError(
            f"calibration: expected a board of {board[0]}x{board[1]} inner corners wholly in view in at least "
            f"{_FEWEST_BOARDS} images, found it in {len(corners)}; count the corners between the squares "
            "(board_columns, board_rows), and photograph the whole board from several sides."
        )
    # The unit of the board cancels: it only scales the distances to it.
    rows, columns = np.mgrid[: board[1], : board[0]]
    target = np.stack([columns, rows, np.zeros_like(rows)], axis=-1).reshape(-1, 3).astype(np.float32)
    with _one_thread():
        rms, matrix, distortion, _, _ = cv2.calibrateCamera(
            [target] * len(corners),
            [points.astype(np.float32).reshape(-1, 1, 2) for points in corners],
            (shape[1], shape[0]),
            None,
            None,
            flags=cv2.CALIB_ZERO_TANGENT_DIST + cv2.CALIB_FIX_K3,
            criteria=_SOLVED,
        )
    camera = Camera(
        width=shape[1],
        height=shape[0],
        fx=float(matrix[0, 0]),
        fy=float(matrix[1, 1]),
        cx=float(matrix[0, 2]),
        cy=float(matrix[1, 2]),
    )
    k1, k2 = (float(value) for value in distortion.ravel()[:2])
    return Calibration(camera, k1, k2, float(rms), len(corners))


@contextmanager
def _one_thread():
    """Keep OpenCV to one thread: several add up the normal equations in an order that changes from run to run."""
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        yield
    finally:
        cv2.setNumThreads(threads)


def check_fit(calibration: Calibration, max_rms: float, what: str) -> None:
    """Refuse a calibration that does not fit its own corners.

    Raises
    ------
    UserError
        If the root mean square error exceeds `max_rms` pixels.
    """
    if calibration.rms > max_rms:
        raise UserError(
            f"{what}: expected corners that fit a camera to {max_rms} pixels, got {calibration.rms:.2f}; use a flat "
            "board, without blur, and keep the zoom fixed."
        )
