"""Parameters of the calibrate stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter


@dataclass(frozen=True)
class CalibrateParams:
    """Which board was photographed, and how it is looked for."""

    board_columns: int = parameter(9, "inner corners along a row of the checkerboard", minimum=3)
    board_rows: int = parameter(6, "inner corners along a column of the checkerboard", minimum=3)
    max_boards: int = parameter(60, "most images looked at, at uniform steps", minimum=3)
    corner_window: int = parameter(
        5,
        "half side of the window in which a corner is refined; less than half a square",
        unit="pixel",
        minimum=2,
    )
    max_rms: float = parameter(
        1.0,
        "root mean square reprojection error above which the calibration is refused",
        unit="pixel",
        exclusive_minimum=0.0,
    )
