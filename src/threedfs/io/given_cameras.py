"""Cameras that a user gives, in any of six formats, told apart by what is in them.

- a COLMAP model: a folder with cameras and images as .bin or .txt (or with sparse/0 or sparse in it);
- transforms.json: entries with `transform_matrix`, camera to world with OpenGL axes (x right, y up, z backward);
- cameras.json: entries with `cam_to_world`, OpenCV axes (x right, y down, z forward);
- a folder of text files: the word CONTOUR, then a 3x4 matrix P with homogeneous pixel = P X;
- a folder of NAME.pose.txt (7-Scenes, 3DMatch) or a file NN.pose (RGB-D Scenes v2): see `rgbd_poses`.

The first three put the centre of the first pixel at (0.5, 0.5), the others at (0, 0).
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from threedfs.checks import check_transform
from threedfs.errors import UserError
from threedfs.geometry.lens import Lens
from threedfs.geometry.projection_matrix import decompose_projection
from threedfs.geometry.rigid import invert, make_transform
from threedfs.io.rgbd_poses import POSE_SUFFIX, Intrinsics, find_intrinsics, read_pose_files, read_pose_lines
from threedfs.poses.given import GivenCamera
from threedfs.types import Camera

_FORMATS = (
    "a COLMAP model folder, transforms.json, cameras.json, a folder of CONTOUR matrices or of NAME.pose.txt, or a "
    "file of RGB-D Scenes v2 with the ending pose"
)
_LARGEST_SIDE = 100_000
_OPENCV_FROM_OPENGL = np.diag([1.0, -1.0, -1.0, 1.0])


def read_given_cameras(path: Path, intrinsics: Intrinsics | None = None) -> tuple[GivenCamera, ...]:
    """Read cameras in the order of their file (a folder: of the names).

    Parameters
    ----------
    path : Path
    intrinsics : tuple of float, optional
        fx, fy, cx, cy in pixels of the source, integer pixel centres, for poses that come without any, or with those
        of another camera (the depth camera's): they go before camera-intrinsics.txt.

    Raises
    ------
    UserError
        If nothing is there, the format is unknown, a camera is not usable, or intrinsics are missing or not wanted.
    """
    path = Path(path)
    if not path.exists():
        raise UserError(f"{path}: expected given cameras ({_FORMATS}), found nothing; check the path.")
    poses, stated = _read_poses(path)
    if poses:
        cameras = _join(path, poses, stated, intrinsics)
    elif intrinsics is not None:
        raise UserError(
            f"{path}: expected poses without intrinsics (NAME{POSE_SUFFIX} or a pose file of RGB-D Scenes v2) to go "
            "with the sequence's key intrinsics, got cameras that state their own; remove that key."
        )
    elif path.is_file():
        cameras = _read_json(path)
    else:
        cameras = _read_folder(path)
    if not cameras:
        raise UserError(f"{path}: expected at least one camera, got none; check the file.")
    for camera in cameras:
        _check_camera(path, camera)
    keys = Counter(camera.name if camera.video_frame is None else camera.video_frame for camera in cameras)
    (key, count), *_ = keys.most_common(1)
    if count > 1:
        raise UserError(
            f"{path}: expected one camera of each image, got {count} of {str(key)[:60]}; remove the others."
        )
    return tuple(cameras)


def _check_camera(path: Path, given: GivenCamera) -> None:
    """Refuse a camera that nothing can be seen with."""
    camera, where = given.lens.camera, f"{path}: {given.name[:60]}"
    numbers = (camera.fx, camera.fy, camera.cx, camera.cy, given.lens.k1, given.lens.k2)
    if not np.all(np.isfinite(numbers)):
        raise UserError(
            f"{where}: expected finite numbers, got fx, fy, cx, cy, k1, k2 of {', '.join(f'{n:g}' for n in numbers)}."
        )
    if camera.fx <= 0 or camera.fy <= 0:
        raise UserError(
            f"{where}: expected positive focal lengths in pixels, got {camera.fx:g} and {camera.fy:g}; check the file."
        )
    # 0 x 0 where the format states no size
    stated = camera.width != 0 or camera.height != 0
    if stated and not (0 < camera.width <= _LARGEST_SIDE and 0 < camera.height <= _LARGEST_SIDE):
        raise UserError(
            f"{where}: expected images of 1 to {_LARGEST_SIDE} pixels a side, got {camera.width}x{camera.height}."
        )
    if not np.all(np.isfinite(given.cam_from_world)):
        raise UserError(f"{where}: expected a pose of finite numbers, got NaN or infinity.")


def _read_poses(path: Path) -> tuple[dict[str, np.ndarray], Intrinsics | None]:
    """Read the poses of an RGB-D data set and its intrinsics, if there are any; no poses for another format."""
    if path.is_dir():
        return read_pose_files(path), find_intrinsics(path)
    return (read_pose_lines(path) if path.suffix == ".pose" else {}), None


def _join(
    path: Path, poses: Mapping[str, np.ndarray], stated: Intrinsics | None, given: Intrinsics | None
) -> list[GivenCamera]:
    intrinsics = stated if given is None else given
    if intrinsics is None:
        raise UserError(
            f"{path}: expected intrinsics of the cameras, in camera-intrinsics.txt beside the poses or by the "
            "sequence's key intrinsics, got none; those of a Kinect's colour camera are about [525, 525, 320, 240]."
        )
    lens = Lens(Camera(0, 0, *map(float, intrinsics)))
    return [GivenCamera(name, None, lens, _rigid_inverse(pose)) for name, pose in poses.items()]


def _read_folder(path: Path) -> list[GivenCamera]:
    for folder in (path, path / "sparse" / "0", path / "sparse"):
        if any((folder / f"images{ending}").is_file() for ending in (".bin", ".txt")):
            return _read_colmap(folder)
    for name in ("transforms.json", "cameras.json"):
        if (path / name).is_file():
            return _read_json(path / name)
    matrices = [file for file in sorted(path.glob("*.txt")) if file.read_text(errors="replace").startswith("CONTOUR")]
    if matrices:
        return [_read_contour(file) for file in matrices]
    raise UserError(f"{path}: expected {_FORMATS}, found none of them in this folder; check the path.")


def _read_colmap(folder: Path) -> list[GivenCamera]:
    # Imported here so that the other formats do without COLMAP.
    from threedfs.colmap.model_files import read_posed_images

    try:
        images = read_posed_images(folder)
    except ValueError as fault:
        raise UserError(
            f"{folder}: expected a COLMAP model with radial distortion at most, got {fault}; "
            "export it again, or undistort the images with COLMAP and give that model."
        ) from fault
    return [GivenCamera(Path(name).stem, None, lens, pose) for name, lens, pose in images]


def _read_json(path: Path) -> list[GivenCamera]:
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        entries = content["frames"]
        return [_read_entry(path, content, entry) for entry in entries]
    except KeyError as fault:
        reason = f"a file without the key {fault} that cameras need"
    except (UnicodeDecodeError, json.JSONDecodeError, RecursionError) as fault:
        reason = f"a file that is no JSON ({str(fault)[:80]})"
    except (TypeError, ValueError, AttributeError, OverflowError) as fault:
        reason = f"a file whose entries are no cameras ({str(fault)[:80]})"
    raise UserError(f"{path}: expected {_FORMATS}, got {reason}; check the file.")


def _read_entry(path: Path, content: Mapping[str, Any], entry: Mapping[str, Any]) -> GivenCamera:
    shared = {**content, **entry}
    if "transform_matrix" in entry:
        name = Path(entry["file_path"]).stem
        pose = np.array(entry["transform_matrix"], np.float64)
        world_from_cam = check_transform(pose, f"{path}: {name}") @ _OPENCV_FROM_OPENGL
        lens = _read_nerf_lens(path, shared)
    else:
        name = str(entry["name"])
        world_from_cam = check_transform(np.array(entry["cam_to_world"]), f"{path}: {name}")
        lens = Lens(
            Camera(
                int(shared["width"]),
                int(shared["height"]),
                float(shared["fx"]),
                float(shared["fy"]),
                float(shared["cx"]) - 0.5,
                float(shared["cy"]) - 0.5,
            ),
            float(shared.get("k1", 0.0)),
            float(shared.get("k2", 0.0)),
        )
    index = entry.get("video_frame")
    return GivenCamera(name, None if index is None else int(index), lens, _rigid_inverse(world_from_cam))


def _read_nerf_lens(path: Path, shared: Mapping[str, Any]) -> Lens:
    if any(abs(float(shared.get(term, 0.0))) > 0 for term in ("p1", "p2", "k3", "k4")):
        raise UserError(
            f"{path}: expected no distortion but k1 and k2, got p1, p2, k3 or k4 other than 0; undistort the images."
        )
    width, height = int(shared["w"]), int(shared["h"])
    if "fl_x" in shared:
        focal_x = float(shared["fl_x"])
    else:
        focal_x = 0.5 * width / np.tan(0.5 * float(shared["camera_angle_x"]))
    camera = Camera(
        width,
        height,
        float(focal_x),
        float(shared.get("fl_y", focal_x)),
        float(shared.get("cx", width / 2)) - 0.5,
        float(shared.get("cy", height / 2)) - 0.5,
    )
    return Lens(camera, float(shared.get("k1", 0.0)), float(shared.get("k2", 0.0)))


def _read_contour(path: Path) -> GivenCamera:
    try:
        projection = np.array(path.read_text().split()[1:], np.float64).reshape(3, 4)
        intrinsics, cam_from_world = decompose_projection(projection)
    except (ValueError, np.linalg.LinAlgError) as fault:
        raise UserError(f"{path}: expected CONTOUR and the 12 numbers of a projection, got {fault}.") from fault
    camera = Camera(
        0,
        0,
        float(intrinsics[0, 0]),
        float(intrinsics[1, 1]),
        float(intrinsics[0, 2]),
        float(intrinsics[1, 2]),
    )
    return GivenCamera(path.stem, None, Lens(camera), cam_from_world)


def _rigid_inverse(world_from_cam: np.ndarray) -> np.ndarray:
    # Printed digits leave a rotation that is orthogonal only to about 1e-9: take the nearest one.
    u, _, vt = np.linalg.svd(world_from_cam[:3, :3])
    return invert(make_transform(u @ vt, world_from_cam[:3, 3]))
