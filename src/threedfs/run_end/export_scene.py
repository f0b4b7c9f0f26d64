"""Cameras, undistorted frames and masks of a sequence, in the layouts that other reconstruction tools read."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from threedfs.crops.resample import resample
from threedfs.errors import UserError
from threedfs.geometry.lens import Lens
from threedfs.io.atomic import atomic
from threedfs.io.frames import FrameStore, read_frames
from threedfs.io.images import write_png
from threedfs.io.meshes import read_mesh
from threedfs.io.points import read_points
from threedfs.io.poses import read_poses
from threedfs.io.scales import find_scale
from threedfs.object.silhouettes import draw_silhouette
from threedfs.run_end.export_masks import mask_path_of, write_masks
from threedfs.run_end.known import require_mesh
from threedfs.types import Camera, Mesh, SparsePoints, View

_CORNER = 0.5
"""COLMAP and nerfstudio count pixels from the corner of the first one, we from its centre."""
_OPENGL = np.diag([1.0, -1.0, -1.0, 1.0])
"""From a camera that looks along z with y down to one that looks against z with y up."""


def export_scene(
    sequence: Path,
    folder: Path,
    method: str = "surface",
    masks: Collection[str] = ("colmap", "nerfstudio"),
    *,
    track: Callable[[Sequence[View]], Iterable[View]] = iter,
) -> int:
    """Write every working frame that has a pose, with its camera and its mask; return how many they are.

    `images/NAME.png` are the frames without distortion; their masks are drawn from the mesh, and written as
    `write_masks` says. `sparse/0` is a COLMAP model in text with the sparse points, `transforms.json` the same cameras
    for nerfstudio and its kin. All in metres if the run found the size, else in scene units. Files that are in the way
    are replaced, others stay.

    Parameters
    ----------
    sequence : Path
        Folder of its results.
    folder : Path
        Made if it is not there.
    method : str
        Whose mesh the masks are drawn from.
    masks : collection of str
        Of `MASKS`: whom they are written for.
    track : callable
        Wraps the loop over frames to report progress.

    Raises
    ------
    UserError
        If the sequence has no cameras, frames or no such mesh.
    """
    places = {"cameras": sequence / "02_poses/poses.json", "frames": sequence / "01_frames/frames.zarr.zip"}
    if folder.exists() and not folder.is_dir():
        raise UserError(f"{folder}: expected a folder to write a scene into, got a file; give another name.")
    for what, path in places.items():
        if not path.is_file():
            raise UserError(f"{path}: expected {what} of a run, found none; correct {sequence}, or run it first.")
    posed, mesh = read_poses(places["cameras"]), read_mesh(require_mesh(sequence, method))
    names = name_files([view.name for view in posed.views])
    _write_images(folder, names, track(posed.views), posed.distortion, read_frames(places["frames"]), mesh, masks)
    scale, points = find_scale(sequence), read_points(sequence / "02_poses/points.zarr.zip")
    unit = 1.0 if scale is None else scale.metres_per_unit
    views = [_resize(view, unit) for view in posed.views]
    _write_model(folder / "sparse/0", names, views, replace(points, xyz=points.xyz * unit))
    _write_json(folder / "transforms.json", _describe_transforms(names, views, "nerfstudio" in masks))
    return len(posed.views)


def _resize(view: View, unit: float) -> View:
    """Return a view of the scene made larger by a factor."""
    pose = view.cam_from_world.copy()
    pose[:3, 3] *= unit
    return replace(view, cam_from_world=pose)


def name_files(names: Sequence[str]) -> dict[str, str]:
    """Return a file name for each frame: COLMAP's text format ends a name at a space.

    Examples
    --------
    >>> name_files(["IMG 1 (2)", "IMG 1_(2)", "000120"])
    {'IMG 1 (2)': 'IMG_1_2.png', 'IMG 1_(2)': 'IMG_1_2_1.png', '000120': '000120.png'}
    """
    files: dict[str, str] = {}
    for name in names:
        stem = re.sub(r"[^A-Za-z0-9.\-]+", "_", name).strip("_") or "frame"
        file, number = f"{stem}.png", 0
        while file in files.values():
            number += 1
            file = f"{stem}_{number}.png"
        files[name] = file
    return files


def _write_images(
    folder: Path,
    names: Mapping[str, str],
    views: Iterable[View],
    distortion: tuple[float, float],
    frames: FrameStore,
    mesh: Mesh,
    masks: Collection[str],
) -> None:
    for view in views:
        image, valid = resample(frames.image(view.name), Lens(view.camera, *distortion), view.camera)
        write_png(folder / "images" / names[view.name], image)
        write_masks(folder, names[view.name], image, draw_silhouette(mesh, view) & valid, masks)


def _write_model(folder: Path, names: Mapping[str, str], views: Sequence[View], points: SparsePoints) -> None:
    """Write cameras.txt, images.txt and points3D.txt; observations of points are not kept, so tracks are empty."""
    numbers: dict[Camera, int] = {}
    for view in views:
        numbers.setdefault(view.camera, len(numbers) + 1)
    cameras = [
        f"{number} PINHOLE {c.width} {c.height} {c.fx:.12g} {c.fy:.12g} {c.cx + _CORNER:.12g} {c.cy + _CORNER:.12g}"
        for c, number in numbers.items()
    ]
    images = []
    for number, view in enumerate(views, start=1):
        x, y, z, w = Rotation.from_matrix(view.cam_from_world[:3, :3]).as_quat(canonical=True)
        pose = " ".join(f"{value:.12g}" for value in (w, x, y, z, *view.cam_from_world[:3, 3]))
        images += [f"{number} {pose} {numbers[view.camera]} {names[view.name]}", ""]
    cloud = [
        f"{number} {x:.9g} {y:.9g} {z:.9g} {r} {g} {b} {error:.6g}"
        for number, ((x, y, z), (r, g, b), error) in enumerate(
            zip(points.xyz, points.rgb, points.error, strict=True), start=1
        )
    ]
    for name, lines in (("cameras.txt", cameras), ("images.txt", images), ("points3D.txt", cloud)):
        with atomic(folder / name) as temporary:
            temporary.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _describe_transforms(names: Mapping[str, str], views: Sequence[View], masked: bool) -> dict:
    frames = []
    for view in views:
        camera = view.camera
        frames.append(
            {
                "file_path": f"images/{names[view.name]}",
                **({"mask_path": mask_path_of(names[view.name])} if masked else {}),
                "transform_matrix": (np.linalg.inv(view.cam_from_world) @ _OPENGL).tolist(),
                **{"w": camera.width, "h": camera.height, "fl_x": camera.fx, "fl_y": camera.fy},
                **{"cx": camera.cx + _CORNER, "cy": camera.cy + _CORNER},
            }
        )
    return {"camera_model": "OPENCV", "k1": 0.0, "k2": 0.0, "p1": 0.0, "p2": 0.0, "frames": frames}


def _write_json(path: Path, content: Mapping) -> None:
    with atomic(path) as temporary:
        temporary.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
