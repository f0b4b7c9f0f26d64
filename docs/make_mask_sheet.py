"""Draw the mask's outline in every keyframe of a sequence, and its mesh from the first, a third and two thirds around.

python docs/make_mask_sheet.py results/beer_video docs/pictures/beer_masks.jpg
"""

from __future__ import annotations

import sys
from pathlib import Path

import cv2
import numpy as np
from make_pictures import fit, outline, shade

from threedfs.io.crops import read_crops
from threedfs.io.keyframes import read_keyframes
from threedfs.io.meshes import read_mesh
from threedfs.io.volumes import read_silhouettes

COLUMNS, WIDTH = 8, 1440


def main(results: Path, picture: Path) -> None:
    """Draw one picture."""
    crops = read_crops(results / "04_crops/crops.zarr.zip")
    keyframes = read_keyframes(results / "04_crops/keyframes.json")
    masks = read_silhouettes(results / "11_object/gc_2d3d_pixel/silhouettes.zarr.zip")
    mesh = read_mesh(results / "11_object/sdf_2d3d_voxel/mesh.ply")
    tiles = [outline(crops.image(name), masks[name]) for name in keyframes]
    names = list(keyframes)
    tiles += [shade(mesh, keyframes[names[number * len(names) // 3]]) for number in range(3)]
    tiles = [fit(tile, WIDTH // COLUMNS, WIDTH // COLUMNS) for tile in tiles]
    tiles += [np.zeros_like(tiles[0])] * (-len(tiles) % COLUMNS)
    sheet = np.vstack([np.hstack(tiles[start : start + COLUMNS]) for start in range(0, len(tiles), COLUMNS)])
    cv2.imwrite(str(picture), sheet[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, 80])


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
