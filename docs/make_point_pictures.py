"""Draw surface points beside the keyframes that they are seen from: in their colours, and shaded by their normals.

    python docs/make_point_pictures.py docs/pictures/points.jpg results/dragon results/tum_bunny

A row a sequence. Drawn are the first keyframe and the one a third around, each as image, points, and shaded points.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np
from make_pictures import write_title

from threedfs.io.crops import read_crops
from threedfs.io.keyframes import read_keyframes
from threedfs.io.oriented_points import read_oriented_points
from threedfs.types import Keyframe, OrientedPoints

HEIGHT = 160
EMPTY = (30, 30, 30)


def draw_points(points: OrientedPoints, colours: np.ndarray, keyframe: Keyframe) -> np.ndarray:
    """Return points as discs in a keyframe, nearer ones over farther ones: (H, W, 3) uint8.

    Points whose normal leads away from the camera are left out.
    """
    pose, camera = keyframe.view.cam_from_world, keyframe.view.camera
    places = points.xyz @ pose[:3, :3].T + pose[:3, 3]
    towards = ((points.normal @ pose[:3, :3].T) * places).sum(axis=1) < 0
    shown = np.flatnonzero((places[:, 2] > 0) & towards)
    shown = shown[np.argsort(-places[shown, 2])]
    image = np.full((camera.height, camera.width, 3), EMPTY, np.uint8)
    pixels = np.array([camera.fx, camera.fy]) * places[shown, :2] / places[shown, 2:] + (camera.cx, camera.cy)
    radius = max(1, camera.width // 500)
    for (column, row), colour in zip(np.round(pixels).astype(int).tolist(), colours[shown].tolist(), strict=True):
        cv2.circle(image, (column, row), radius, colour, -1)
    return image


def draw_row(results: Path) -> np.ndarray:
    """Return the pictures of one sequence, side by side."""
    crops = read_crops(results / "04_crops/crops.zarr.zip")
    keyframes = read_keyframes(results / "04_crops/keyframes.json")
    names = list(keyframes)
    points, _ = read_oriented_points(results / "08_densify/points.zarr.zip")
    tiles = []
    for name in (names[0], names[len(names) // 3]):
        image, keyframe = crops.image(name), keyframes[name]
        away = points.normal @ keyframe.view.cam_from_world[2, :3]
        shades = np.repeat(np.clip(-255 * away, 0, 255).astype(np.uint8)[:, None], 3, axis=1)
        for tile in (image, draw_points(points, points.rgb, keyframe), draw_points(points, shades, keyframe)):
            width = round(tile.shape[1] * HEIGHT / tile.shape[0])
            tiles.append(cv2.resize(tile, (width, HEIGHT), interpolation=cv2.INTER_AREA))
    row = np.hstack(tiles)
    write_title(row, f"{results.name}: {len(points.xyz)} points")
    return row


def main(picture: Path, sequences: Sequence[Path]) -> None:
    """Draw one picture."""
    rows = [draw_row(results) for results in sequences]
    width = max(row.shape[1] for row in rows)
    rows = [np.pad(row, ((0, 0), (0, width - row.shape[1]), (0, 0))) for row in rows]
    cv2.imwrite(str(picture), np.vstack(rows)[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, 78])


if __name__ == "__main__":
    main(Path(sys.argv[1]), [Path(name) for name in sys.argv[2:]])
