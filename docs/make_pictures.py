"""Draw the README's pictures from the results of a sequence.

    python docs/make_pictures.py results/sample docs/pictures/sample.jpg [MASKS_OF MESH_OF]

Four keyframes side by side; from top to bottom the crop with the mask's outline, the depth (near is red), the
normals of the depth, the mesh as the same camera sees it, and the same with
its texture, or else its colours, if any. Masks are those of
gc_2d3d_pixel and the mesh that of surface where no methods are named.
"""

from __future__ import annotations

import sys
from pathlib import Path

import cv2
import numpy as np

from threedfs.geometry.projection import normals_from_depth, pixel_grid
from threedfs.geometry.raycast import RayCaster
from threedfs.io.colored_meshes import read_colored_mesh
from threedfs.io.crops import read_crops
from threedfs.io.depth_maps import read_depth_map
from threedfs.io.keyframes import read_keyframes
from threedfs.io.meshes import read_mesh
from threedfs.io.textured_meshes import read_textured_obj
from threedfs.io.volumes import read_silhouettes
from threedfs.report.pictures import color_depth, color_normals, outline_mask
from threedfs.texture.photograph import Photographer, photograph_texture, photograph_vertices
from threedfs.types import Keyframe, Mesh

COLUMNS, WIDTH = 4, 1400


def write_title(image: np.ndarray, title: str) -> None:
    """Write a title into an image's upper left corner, on a dark ground."""
    (width, height), _ = cv2.getTextSize(title, cv2.FONT_HERSHEY_SIMPLEX, 0.5, 1)
    cv2.rectangle(image, (0, 0), (width + 12, height + 12), (30, 30, 30), -1)
    cv2.putText(image, title, (6, height + 5), cv2.FONT_HERSHEY_SIMPLEX, 0.5, (255, 255, 255), 1, cv2.LINE_AA)


def find_photographer(folder: Path) -> Photographer | None:
    """Return what photographs a method's mesh with its texture, or else its vertices' colours; None without any."""
    textured = folder / "textured" / "mesh.obj"
    if textured.is_file():
        return photograph_texture(read_textured_obj(textured))
    mesh, colors = read_colored_mesh(folder / "mesh.ply")
    return None if colors is None else photograph_vertices(mesh, colors)


def render(mesh: Mesh, keyframe: Keyframe) -> np.ndarray:
    """Render the mesh with one lamp beside the camera."""
    view, camera = keyframe.view, keyframe.view.camera
    u, v = pixel_grid(camera)
    rotation = view.cam_from_world[:3, :3]
    rays = np.stack([(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, np.ones_like(u)], -1) @ rotation
    hits = RayCaster(mesh).first_hits(np.broadcast_to(view.centre, (u.size, 3)), rays.reshape(-1, 3))
    corners = mesh.vertices[mesh.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    triangle = hits.triangle.reshape(u.shape)
    facing = (normals[np.maximum(triangle, 0)] @ rotation.T) @ np.array([-0.3, -0.4, -0.85])
    grey = np.where(triangle >= 0, np.clip(facing, 0.08, 1) * 255, 30).astype(np.uint8)
    return np.repeat(grey[..., None], 3, axis=-1)


def photograph(photographer: Photographer, keyframe: Keyframe) -> np.ndarray:
    """Photograph the mesh before dark grey."""
    image, shown = photographer.take(keyframe.view)
    return np.where(shown[..., None], image.clip(0, 255), 30).astype(np.uint8)


def fit(image: np.ndarray, width: int, height: int) -> np.ndarray:
    """Return an image in the middle of a black tile, as large as fits."""
    scale = min(width / image.shape[1], height / image.shape[0])
    size = (max(1, round(scale * image.shape[1])), max(1, round(scale * image.shape[0])))
    small = cv2.resize(image, size, interpolation=cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR)
    tile = np.zeros((height, width, 3), np.uint8)
    top, left = (height - size[1]) // 2, (width - size[0]) // 2
    tile[top : top + size[1], left : left + size[0]] = small
    return tile


def main(results: Path, picture: Path, masks: str = "gc_2d3d_pixel", surface: str = "surface") -> None:
    """Draw one picture: the masks of one method, the mesh of another."""
    crops = read_crops(results / "04_crops/crops.zarr.zip")
    keyframes = read_keyframes(results / "04_crops/keyframes.json")
    silhouettes = read_silhouettes(results / f"11_object/{masks}/silhouettes.zarr.zip")
    folder = results / "11_object" / surface
    mesh, photographer = read_mesh(folder / "mesh.ply"), find_photographer(folder)
    names = list(keyframes)
    width, columns = WIDTH // COLUMNS, []
    for name in names[:: max(1, len(names) // COLUMNS)][:COLUMNS]:
        keyframe = keyframes[name]
        depth = read_depth_map(results / f"06_depth/{name}.zarr.zip").depth
        rows = [
            outline_mask(crops.image(name), silhouettes[name]),
            color_depth(depth, keyframe),
            color_normals(normals_from_depth(keyframe.view.camera, depth)),
            render(mesh, keyframe),
            *([photograph(photographer, keyframe)] if photographer else []),
        ]
        columns.append(np.vstack([fit(row, width, width) for row in rows]))
    cv2.imwrite(str(picture), np.hstack(columns)[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, 88])


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), *sys.argv[3:])
