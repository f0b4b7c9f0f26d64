"""Calibrate the lens from photos or a video of a checkerboard (Section 3.1)."""

from __future__ import annotations

from pathlib import Path

from threedfs.frames.calibrate import calibrate, check_fit, find_board
from threedfs.frames.decode import FrameReader, choose_step, scan_source
from threedfs.io.calibration import write_calibration
from threedfs.job import Job
from threedfs.params.calibrate import CalibrateParams


def run(*, boards: Path, calibration: Path, params: CalibrateParams, job: Job) -> None:
    """Read images of the board at full resolution; write calibration.json.

    Raises
    ------
    UserError
        If the board is found in too few of them, or the fit is worse than `max_rms`.
    """
    source = scan_source(boards, job.progress)
    reader = FrameReader(
        source,
        job.progress,
        longest_side=max(source.shape),
        step=choose_step(len(source.names), params.max_boards),
    )
    board = (params.board_columns, params.board_rows)
    found = (find_board(frame.image, board, params.corner_window) for frame in reader)
    corners = [points for points in found if points is not None]
    result = calibrate(corners, board, source.shape)
    check_fit(result, params.max_rms, str(boards))
    write_calibration(calibration, result, job.header)
    camera = result.camera
    job.progress.note(
        f"board found in {len(corners)} of {reader.taken} images; fx = {camera.fx:.1f}, fy = {camera.fy:.1f}, "
        f"cx = {camera.cx:.1f}, cy = {camera.cy:.1f}, k1 = {result.k1:.4f}, k2 = {result.k2:.4f}, "
        f"rms {result.rms:.3f} px"
    )
