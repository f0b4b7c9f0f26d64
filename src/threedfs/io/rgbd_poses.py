"""Camera poses as two layouts of RGB-D data sets have them; neither states distortion or the size of its images.

- 7-Scenes and 3DMatch: beside each frame-NNNNNN.color image a frame-NNNNNN.pose.txt, a 4x4 matrix camera to world; and
  one camera-intrinsics.txt, a 3x3 matrix, in the same folder. (3DMatch keeps it one folder higher, where an edit of it
  would go unnoticed by the store: it is to be copied to the frames.)
- RGB-D Scenes v2: pc/NN.pose, one line for each image NNNNN-color of imgs/scene_NN in their order: a quaternion, w
  first, and a translation, taken as camera to world.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from threedfs.checks import check_transform
from threedfs.errors import UserError
from threedfs.geometry.rigid import make_transform

POSE_SUFFIX = ".pose.txt"
INTRINSICS_FILE = "camera-intrinsics.txt"
_LOOSE = 1e-2
"""Poses of 7-Scenes are products in single precision of many steps of a tracker: off by up to 1e-3."""

Intrinsics = Sequence[float]
"""fx, fy, cx, cy in pixels of the images, integer pixel centres."""


def read_pose_files(folder: Path) -> dict[str, np.ndarray]:
    """Read the poses of a folder in the layout of 7-Scenes.

    Returns
    -------
    dict of str to (4, 4) float64
        Camera to world by the stem of the image, NAME.color, its rotation as printed, that is nearly one. A frame
        whose pose is not finite was lost by the tracker and is left out.

    Raises
    ------
    UserError
        If a file is no rigid 4x4 matrix.
    """
    poses = {}
    for file in sorted(Path(folder).glob(f"*{POSE_SUFFIX}")):
        matrix = _read_matrix(file, (4, 4))
        if np.all(np.isfinite(matrix)):
            name = f"{file.name.removesuffix(POSE_SUFFIX)}.color"
            poses[name] = check_transform(matrix, str(file), _LOOSE)
    return poses


def find_intrinsics(folder: Path) -> Intrinsics | None:
    """Read camera-intrinsics.txt of a folder; None if there is none.

    Raises
    ------
    UserError
        If it is no 3x3 matrix of a camera.
    """
    file = Path(folder) / INTRINSICS_FILE
    if not file.is_file():
        return None
    matrix = _read_matrix(file, (3, 3))
    if not (np.all(np.isfinite(matrix)) and matrix[0, 0] > 0 and matrix[1, 1] > 0):
        raise UserError(f"{file}: expected focal lengths on the diagonal, got {matrix.tolist()}.")
    return matrix[0, 0], matrix[1, 1], matrix[0, 2], matrix[1, 2]


def read_pose_lines(path: Path) -> dict[str, np.ndarray]:
    """Read the poses of an RGB-D Scenes v2 scene.

    Returns
    -------
    dict of str to (4, 4) float64
        Camera to world by the stem of the image, NNNNN-color, counted from 0.

    Raises
    ------
    UserError
        If a line is no unit quaternion and translation.
    """
    poses = {}
    for number, line in enumerate(Path(path).read_text(errors="replace").splitlines()):
        try:
            values = np.array(line.split(), np.float64)
        except ValueError:
            values = np.empty(0)
        # Printed digits leave a length of 1 only to about 1e-5.
        if values.shape != (7,) or abs(np.linalg.norm(values[:4]) - 1) > 1e-3:
            raise UserError(
                f"{path}: expected a unit quaternion, w first, and a translation, seven numbers, in line {number + 1}, "
                f"got {line.strip()!r}."
            )
        rotation = Rotation.from_quat(np.roll(values[:4], -1)).as_matrix()
        poses[f"{number:05d}-color"] = make_transform(rotation, values[4:])
    return poses


def _read_matrix(file: Path, shape: tuple[int, int]) -> np.ndarray:
    try:
        return np.array(file.read_text(errors="replace").split(), np.float64).reshape(shape)
    except ValueError as fault:
        raise UserError(f"{file}: expected a {shape[0]}x{shape[1]} matrix, got {fault}.") from fault
