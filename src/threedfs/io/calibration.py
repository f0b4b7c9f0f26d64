"""The calibration of a lens: its camera, radial distortion and how well they fit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from threedfs.io.documents import read_document, write_document
from threedfs.io.schema import Schema
from threedfs.types import Camera

CALIBRATION = Schema("threedfs/calibration/1", "calibrate")


@dataclass(frozen=True)
class Calibration:
    """What photos of a checkerboard tell of the camera that took them.

    Attributes
    ----------
    camera : Camera
        At the resolution of the board's images; integer coordinates are pixel centres.
    k1, k2 : float
        Radial distortion: normalised (x, y) is imaged at (x, y) (1 + k1 r^2 + k2 r^4).
    rms : float
        Root mean square distance between found and projected corners, pixels of the board's images.
    boards : int
        Images in which the board was found.
    """

    camera: Camera
    k1: float
    k2: float
    rms: float
    boards: int


def write_calibration(path: Path, calibration: Calibration, header: Mapping[str, Any]) -> None:
    """Write calibration.json."""
    content = {"axes": "integer pixel coordinates are pixel centres", **asdict(calibration)}
    write_document(path, CALIBRATION, content, header)


def read_calibration(path: Path) -> Calibration:
    """Read calibration.json."""
    content = read_document(path, CALIBRATION)
    return Calibration(
        camera=Camera(**content["camera"]),
        k1=content["k1"],
        k2=content["k2"],
        rms=content["rms"],
        boards=content["boards"],
    )
