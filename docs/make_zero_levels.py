"""Draw meshes by several methods side by side, and how their zero levels run through a cut.

    python docs/make_zero_levels.py results/dragon docs/pictures/zero_levels_dragon.jpg tsdf fused_sdf deformed_sdf

A column a method, of those that take the object from a field; the true mesh last, where the sequence is rendered.
The first two rows show the meshes from two keyframes, the last the field of the method in the upright plane through
the middle of the object along its longer side: inside dark, outside light; its zero level red, the true one green.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np
from make_pictures import shade, write_title
from scipy.ndimage import map_coordinates

from threedfs.geometry.grid import voxel_from_world
from threedfs.geometry.raycast import RayCaster
from threedfs.io.keyframes import read_keyframes
from threedfs.io.meshes import read_mesh
from threedfs.io.volumes import read_support, read_volume
from threedfs.run_end.film import relate_film
from threedfs.types import Mesh, Plane, VoxelGrid

TILE = (420, 315)
FINE = 3
"""Samples per voxel in the cut."""
FIELDS = {
    "fused_sdf": "07_fusion/object.zarr.zip",
    "deformed_sdf": "09_deform/volume.zarr.zip",
    "tsdf": "07_fusion/baseline/tsdf.zarr.zip",
    "soft_maximum": "07_fusion/baseline/soft_maximum.zarr.zip",
    "hard_maximum": "07_fusion/baseline/hard_maximum.zarr.zip",
}


def true_mesh(results: Path) -> Mesh | None:
    """Return the mesh of a rendered sequence in the frame of the reconstruction; none where it is not rendered."""
    folder = results / "00_render"
    if not folder.is_dir():
        return None
    truth_from_scene = relate_film(results).from_scene
    mesh = read_mesh(folder / "mesh.ply")
    back = (mesh.vertices - truth_from_scene.translation) @ truth_from_scene.rotation / truth_from_scene.scale
    return Mesh(back, mesh.faces)


def lay_cut(plane: Plane, middle: np.ndarray, mesh: Mesh, grid: VoxelGrid) -> np.ndarray:
    """Return the world points (rows, columns, 3) of the upright plane through a point, along the mesh's longer side."""
    flat = mesh.vertices - np.outer(mesh.vertices @ plane.normal, plane.normal)
    along = np.linalg.svd(flat - flat.mean(axis=0), full_matrices=False)[2][0]
    offsets, heights = (mesh.vertices - middle) @ along, (mesh.vertices - middle) @ plane.normal
    step, margin = grid.spacing / FINE, 6 * grid.spacing
    across = np.arange(offsets.min() - margin, offsets.max() + margin, step)
    up = np.arange(heights.max() + margin, heights.min() - margin, -step)
    return middle + across[None, :, None] * along + up[:, None, None] * plane.normal


def draw_cut(field: Path, points: np.ndarray, truth: Mesh | None) -> np.ndarray:
    """Return the field in a cut (rows, columns, 3), with the zero levels."""
    volume = read_volume(field)
    places = voxel_from_world(volume.grid, points.reshape(-1, 3)).T
    sdf = map_coordinates(volume.sdf, places, order=1, mode="constant", cval=1).reshape(points.shape[:2])
    picture = np.repeat((140 + 100 * np.clip(sdf, -1, 1)).astype(np.uint8)[..., None], 3, axis=-1)
    levels = [(sdf < 0, (220, 30, 30))]
    if truth is not None:
        levels.append((inside(truth, points), (20, 160, 40)))
    for solid, colour in levels:
        contours, _ = cv2.findContours(solid.astype(np.uint8), cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE)
        cv2.drawContours(picture, contours, -1, colour, 1)
    return picture


def inside(mesh: Mesh, points: np.ndarray) -> np.ndarray:
    """Say which points (..., 3) a closed mesh encloses: those that see it from within along one direction."""
    rays = np.broadcast_to([0.123, 0.456, 0.881], (points[..., 0].size, 3))
    triangle = RayCaster(mesh).first_hits(points.reshape(-1, 3), rays).triangle
    corners = mesh.vertices[mesh.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    leaves = (normals @ rays[0])[np.maximum(triangle, 0)] > 0
    return ((triangle >= 0) & leaves).reshape(points.shape[:-1])


def fit(image: np.ndarray, title: str) -> np.ndarray:
    """Return an image in a tile with a title."""
    scale = min(TILE[0] / image.shape[1], TILE[1] / image.shape[0])
    small = cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR)
    tile = np.full((TILE[1], TILE[0], 3), 255, np.uint8)
    tile[: small.shape[0], : small.shape[1]] = small
    write_title(tile, title)
    return tile


def crop(image: np.ndarray, shown: np.ndarray) -> np.ndarray:
    """Return the part of an image around a mask."""
    rows, columns = np.nonzero(shown.any(axis=1))[0], np.nonzero(shown.any(axis=0))[0]
    return image[max(0, rows[0] - 12) : rows[-1] + 12, max(0, columns[0] - 12) : columns[-1] + 12]


def main(results: Path, picture: Path, methods: Sequence[str]) -> None:
    """Draw one picture."""
    keyframes = list(read_keyframes(results / "04_crops/keyframes.json").values())
    support = read_support(results / "03_scene/support.json")
    meshes = {method: read_mesh(results / f"11_object/{method}/mesh.ply") for method in methods}
    truth = true_mesh(results)
    if truth is not None:
        meshes["truth"] = truth
    last = list(meshes.values())[-1]
    grid = read_volume(results / FIELDS[methods[0]]).grid
    points = lay_cut(support.plane, last.vertices.mean(axis=0), last, grid)
    columns = []
    for name, mesh in meshes.items():
        rows = []
        for keyframe in (keyframes[0], keyframes[len(keyframes) // 3]):
            wanted = shade(last, keyframe)[..., 0] != 30
            rows.append(fit(crop(shade(mesh, keyframe), wanted), name))
        if name in FIELDS:
            rows.append(fit(draw_cut(results / FIELDS[name], points, truth), f"{name}: cut"))
        else:
            rows.append(np.full((TILE[1], TILE[0], 3), 255, np.uint8))
        columns.append(np.vstack(rows))
    cv2.imwrite(str(picture), np.hstack(columns)[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, 85])


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3:])
