"""How tall meshes come out whose size is told by a tag, by a checkerboard, or by the object's height.

    python benchmarks/scale.py FOLDER [--quality normal]

Films the sample's gnome with a tag and a board beside it into FOLDER, unless the film is there, and runs `threedfs run`
on it three times; the second and the third time only the size is found anew. Prints how far the height of each STL is
from the true one, and how far the size of the scene is from that of the true cameras. The given height is that of the
mesh by construction; for it, the size of the scene tells how wrong the mesh's own height is.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import trimesh

from threedfs.evaluate.pose_error import align_poses
from threedfs.io.given_cameras import read_given_cameras
from threedfs.io.meshes import read_mesh
from threedfs.io.poses import read_poses
from threedfs.io.scales import read_scale
from threedfs.progress import Progress
from threedfs.synthetic.export import FilmFiles, write_film
from threedfs.synthetic.film import Film
from threedfs.synthetic.render import Renderer
from threedfs.synthetic.sample import MASK_STEP, QUALITY, sample_film
from threedfs.synthetic.solid import Material, Texture
from threedfs.synthetic.table import Sheet

TAG, SQUARE, CORNERS = 0.04, 0.015, (6, 4)  # metres; inner corners of the board
WHITE, BLACK = 0.75, 0.03  # linear light of paper and ink
CELL = 0.0005  # metres: a pixel of a printed page


def draw_tag() -> np.ndarray:
    """Return a page with a tag, and a margin of half its side around it, linear light."""
    side = round(TAG / CELL)
    tag = cv2.aruco.generateImageMarker(cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50), 3, side)
    return np.pad(np.where(tag > 0, WHITE, BLACK), side // 2, constant_values=WHITE)


def draw_board() -> np.ndarray:
    """Return a page with a checkerboard, and a margin of a square around it, linear light."""
    side = round(SQUARE / CELL)
    black = np.add.outer(np.arange(CORNERS[1] + 1), np.arange(CORNERS[0] + 1)) % 2 == 0
    return np.pad(np.where(np.kron(black, np.ones((side, side))) > 0, BLACK, WHITE), side, constant_values=WHITE)


def print_page(page: np.ndarray) -> Texture:
    """Make a texture of a page (R, C) with its middle at the origin; pixels see the mean of what they cover."""
    rows, columns = page.shape
    levels = [cv2.blur(page, (2**level + 1,) * 2).astype(np.float32) for level in range(4)]

    def texture(points: np.ndarray, footprint: np.ndarray) -> np.ndarray:
        u = (points[:, 0] / CELL + (columns - 1) / 2).astype(np.float32)[:, None]
        v = (-points[:, 1] / CELL + (rows - 1) / 2).astype(np.float32)[:, None]
        if not len(u):
            return np.zeros((0, 3))
        fineness = np.clip(np.rint(np.log2(np.maximum(footprint / CELL, 1))).astype(int), 0, len(levels) - 1)
        seen = np.empty(len(u))
        for level, image in enumerate(levels):
            at = fineness == level
            if at.any():
                seen[at] = cv2.remap(image, u[at], v[at], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)[:, 0]
        return np.repeat(seen[:, None], 3, axis=1)

    return texture


def lay(page: np.ndarray, centre: tuple[float, float], angle: float) -> Sheet:
    """Lay a page on the table."""
    rows, columns = page.shape
    return Sheet(centre, (columns * CELL / 2, rows * CELL / 2), angle, Material(print_page(page), 0.03, 30))


def make_film() -> Film:
    """Return the sample's film at half its rate, with a tag and a board on the table."""
    film = sample_film()
    sheets = (*film.scene.table.sheets, lay(draw_tag(), (-0.15, -0.12), -18.0), lay(draw_board(), (0.16, 0.11), 12.0))
    table = replace(film.scene.table, sheets=sheets)
    return replace(film, scene=replace(film.scene, table=table), frames=film.frames // 2, rate=film.rate // 2)


def run(folder: Path, quality: str, known: list[str]) -> tuple[float, float]:
    """Run the command; return the height of the STL and what the scale says of a scene unit, metres."""
    command = [sys.executable, "-m", "threedfs.cli.main", "run", str(folder / "video.mp4"), "--out", str(folder)]
    subprocess.run([*command, "--quality", quality, "--cores", str(os.cpu_count()), *known], check=True)
    height = float(trimesh.load(folder / "video.stl").extents[2]) / 1000
    return height, read_scale(folder / "results/video/11_object/scale.json").metres_per_unit


def measure_unit(folder: Path) -> float:
    """Return the true size of a unit of the finished results, metres."""
    true = {given.name: given.cam_from_world for given in read_given_cameras(folder / "cameras.json")}
    views = [view for view in read_poses(folder / "results/video/02_poses/poses.json").views if view.name in true]
    return align_poses([view.cam_from_world for view in views], [true[view.name] for view in views]).scale


def main() -> None:
    """Print a line for each way to tell the size."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--quality", default="draft", choices=("draft", "normal", "fine"))
    arguments = parser.parse_args()
    folder = arguments.folder.resolve()
    if not (folder / "video.mp4").is_file():
        film, files = make_film(), FilmFiles.below(folder, depth=False)
        options = {"mask_step": MASK_STEP, "quality": QUALITY, "processes": os.cpu_count() or 1}
        write_film(files, film, Renderer(film.scene), progress=Progress("film"), **options)
    tall = float(np.ptp(read_mesh(folder / "mesh.ply").vertices[:, 2]))
    board = f"{CORNERS[0]}x{CORNERS[1]}:{1000 * SQUARE:g}mm"
    told = {"tag": f"{1000 * TAG:g}mm", "board": board, "height": f"{1000 * tall:.4f}mm"}
    found = {way: run(folder, arguments.quality, [f"--{way}", size]) for way, size in told.items()}
    unit = measure_unit(folder)
    for way, (height, scale) in found.items():
        print(
            f"{way:7} mesh {1000 * height:.2f} mm tall, {100 * (height / tall - 1):+.2f} % of {1000 * tall:.2f} mm; "
            f"a scene unit is {1000 * scale:.2f} mm, {100 * (scale / unit - 1):+.2f} % of {1000 * unit:.2f} mm"
        )


if __name__ == "__main__":
    main()
