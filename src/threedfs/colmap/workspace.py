"""COLMAP's workspace of multi-view stereo: a folder of images, cameras, and depth and normal maps."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import pycolmap

from threedfs.errors import UserError
from threedfs.types import Box, OrientedPoints, View

Track = tuple[np.ndarray, Sequence[int]]
"""A point (3,) in the world, and the ranks of the views that see it."""


@dataclass(frozen=True)
class FusionRule:
    """When pixels of depth maps are one point.

    Attributes
    ----------
    min_pixels : int
        Pixels, of all views together, that a point must have.
    max_depth_error : float
        Relative difference of depth between two views.
    max_reprojection_error : float
        In pixels.
    max_normal_error : float
        Angle between normals, degrees.
    """

    min_pixels: int
    max_depth_error: float
    max_reprojection_error: float
    max_normal_error: float


def write_workspace(
    folder: Path, views: Sequence[View], read_image: Callable[[str], np.ndarray], tracks: Iterable[Track]
) -> None:
    """Write the images and cameras of views, and sparse points, which say what views overlap.

    COLMAP's stereo counts pixels from 0 at the centre of the first one, unlike the rest of COLMAP: the principal
    point is written without the half pixel.

    Parameters
    ----------
    folder : Path
        An empty folder.
    views : sequence of View
        Without distortion.
    read_image : callable
        Gives the image (H, W, 3) uint8 RGB of a view by its name.
    tracks : iterable of Track
    """
    for part in ("images", "sparse", "stereo/depth_maps", "stereo/normal_maps", "stereo/consistency_graphs"):
        (folder / part).mkdir(parents=True)
    observed = [(np.asarray(point, np.float64), list(ranks)) for point, ranks in tracks]
    model = pycolmap.Reconstruction()
    keypoints = np.zeros(len(views), int)
    elements = []
    for _, ranks in observed:
        elements.append([pycolmap.TrackElement(rank + 1, int(keypoints[rank])) for rank in ranks])
        keypoints[ranks] += 1
    for rank, view in enumerate(views):
        camera = view.camera
        model.add_camera_with_trivial_rig(
            pycolmap.Camera(
                camera_id=rank + 1,
                model=pycolmap.CameraModelId.PINHOLE,
                width=camera.width,
                height=camera.height,
                params=[camera.fx, camera.fy, camera.cx, camera.cy],
            )
        )
        image = pycolmap.Image(
            name=_file_of(view), keypoints=np.zeros((keypoints[rank], 2)), camera_id=rank + 1, image_id=rank + 1
        )
        model.add_image_with_trivial_frame(image, pycolmap.Rigid3d(view.cam_from_world[:3]))
        cv2.imwrite(str(folder / "images" / _file_of(view)), np.ascontiguousarray(read_image(view.name)[..., ::-1]))
    for (point, _), track in zip(observed, elements, strict=True):
        model.add_point3D(point, pycolmap.Track(track))
    model.write(folder / "sparse")
    names = [_file_of(view) for view in views]
    (folder / "stereo" / "fusion.cfg").write_text("".join(f"{name}\n" for name in names), encoding="utf-8")
    sources = "".join(f"{name}\n__auto__, 20\n" for name in names)
    (folder / "stereo" / "patch-match.cfg").write_text(sources, encoding="utf-8")


def write_patch_map(folder: Path, view: View, depth: np.ndarray, normal: np.ndarray) -> None:
    """Write the depth and normal map of a view into a workspace.

    Parameters
    ----------
    folder : Path
    view : View
    depth : (H, W) float32
        Camera-frame z, scene units, NaN where there is none.
    normal : (H, W, 3) float32
        Unit normals towards the camera, camera frame.
    """
    known = np.isfinite(depth)
    name = f"{_file_of(view)}.geometric.bin"
    bounds = (float(depth[known].min()), float(depth[known].max())) if known.any() else (0.0, 0.0)
    filled = np.where(known, depth, 0).astype(np.float32)
    pycolmap.DepthMap.from_array(filled, *bounds).write(folder / "stereo" / "depth_maps" / name)
    facing = np.where(known[..., None], normal, 0).astype(np.float32)
    # COLMAP holds one plane per coordinate; `from_array` copies the values in the order in which they lie.
    planes = np.ascontiguousarray(np.moveaxis(facing, -1, 0)).reshape(facing.shape)
    pycolmap.NormalMap.from_array(planes).write(folder / "stereo" / "normal_maps" / name)


def match_on_gpu(folder: Path, window_radius: int) -> None:
    """Fill a workspace with the depth and normal maps of all views by COLMAP's own patch match.

    Raises
    ------
    UserError
        If COLMAP was built without CUDA, or there is no GPU.
    """
    if not can_match_on_gpu():
        raise UserError(
            "densify.engine: to match patches on the GPU, expected COLMAP built with CUDA, and a GPU, found "
            f"{'no GPU' if pycolmap.has_cuda else 'one built without'}; set it to cpu, or, where jobs run on the "
            "machine that starts them, to auto, which takes what there is."
        )
    options = pycolmap.PatchMatchOptions(window_radius=window_radius)
    pycolmap.patch_match_stereo(folder, options=options)


def can_match_on_gpu() -> bool:
    """Say whether COLMAP can match patches here: built with CUDA; without a GPU it would end the process."""
    return bool(pycolmap.has_cuda) and pycolmap.get_num_cuda_devices() > 0


def fuse_workspace(folder: Path, rule: FusionRule, box: Box) -> OrientedPoints:
    """Fuse the maps of a workspace to oriented points, on one thread.

    A point is the median of its pixels, and so is its normal.

    Parameters
    ----------
    folder : Path
    rule : FusionRule
    box : Box
        Outside of it nothing is fused.
    """
    corners = box.corners()  # COLMAP's own box lies along the axes of the world
    options = pycolmap.StereoFusionOptions(
        num_threads=1,
        min_num_pixels=rule.min_pixels,
        max_depth_error=rule.max_depth_error,
        max_reproj_error=rule.max_reprojection_error,
        max_normal_error=rule.max_normal_error,
        bounding_box=(corners.min(axis=0).astype(np.float32), corners.max(axis=0).astype(np.float32)),
    )
    path = folder / "fused.ply"
    pycolmap.stereo_fusion(path, folder, options=options, output_type="PLY")
    found = OrientedPoints(*_read_ply(path), *_read_visibility(Path(f"{path}.vis")))
    return found.take(box.contains(found.xyz))


def _file_of(view: View) -> str:
    return f"{view.name}.png"


def _read_ply(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    header, _, body = path.read_bytes().partition(b"end_header\n")
    kinds = {b"float": "<f4", b"uchar": "u1"}
    words = [line.split() for line in header.splitlines()]
    fields = [(word[2].decode(), kinds[word[1]]) for word in words if word[0] == b"property"]
    points = np.frombuffer(body, np.dtype(fields))
    groups = (("x", "y", "z"), ("nx", "ny", "nz"), ("red", "green", "blue"))
    xyz, normal, rgb = (np.stack([points[name] for name in names], axis=1) for names in groups)
    return xyz, normal, rgb


def _read_visibility(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Read for every point the ranks of the views it is made from, as pairs in order."""
    numbers = np.frombuffer(path.read_bytes(), "<u4").astype(np.int64)
    points, views, place = [], [], 2  # a count of 64 bits stands first
    for point in range(numbers[0] + (numbers[1] << 32)):
        count = numbers[place]
        points.append(np.full(count, point))
        views.append(np.sort(numbers[place + 1 : place + 1 + count]))
        place += 1 + count
    empty = [np.zeros(0, np.int64)]
    return np.concatenate(points or empty), np.concatenate(views or empty)
