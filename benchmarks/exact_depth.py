"""Put true depth in the place of the depth maps of a rendered take, to see what the stages after it make of that.

    snakemake --cores 2 --configfile CONFIG -- results/NAME/06_depth    # or a whole run
    python benchmarks/exact_depth.py results/NAME [results/NAME ...]
    snakemake --cores 2 --configfile CONFIG --rerun-triggers mtime -- results/NAME/12_evaluate/METHOD/metrics.csv ...

Keyframes must have a true depth image (`keyframes_at_truth: true`). Where the renderer saw nothing, there is no depth.
Cameras stay as estimated: true depth is divided by their scale. So do the plane and the box, from the scene pass.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from command import run_command

from threedfs.evaluate.rendering import filmed_pixels, sample_nearest
from threedfs.io.arrays import read_arrays
from threedfs.io.crops import read_crops
from threedfs.io.depth_maps import DEPTH_MAP, DepthMap, write_depth_map
from threedfs.io.frames import read_frames
from threedfs.io.keyframes import read_keyframes
from threedfs.io.poses import read_poses
from threedfs.io.truth import read_true_depth
from threedfs.io.truth_files import find_depth_images
from threedfs.params.rendered import DEPTH_SCALE
from threedfs.run_end.film import find_film, relate_film
from threedfs.store.made import Made


def find_filmed_pixels(folder: Path) -> dict[str, np.ndarray]:
    """Return where each pixel of the keyframes' crops lies in the source's frames, (H, W, 2) float64 each."""
    frames, solved = read_frames(folder / "01_frames/frames.zarr.zip"), read_poses(folder / "02_poses/poses.json")
    whole = {view.name: view.camera for view in solved.views}
    return {
        name: filmed_pixels(keyframe.view.camera, whole[name], solved.distortion, frames.source_shape)
        for name, keyframe in read_keyframes(folder / "04_crops/keyframes.json").items()
    }


def read_true_depths(folder: Path) -> Iterator[tuple[str, np.ndarray, np.ndarray]]:
    """Yield each keyframe of the run in `folder`: its name, `find_filmed_pixels`, and true depth (H, W) in scene units.

    NaN where the renderer saw nothing.
    """
    true_cameras, source_shape = relate_film(folder), read_frames(folder / "01_frames/frames.zarr.zip").source_shape
    places = find_filmed_pixels(folder)
    images = find_depth_images(find_film(folder) / "depth", places)
    lacking = sorted(set(places) - set(images))
    if lacking:
        raise SystemExit(f"{folder}: expected true depth of all keyframes, found none of {', '.join(lacking)}.")
    for name, pixels in places.items():
        image = read_true_depth(images[name], DEPTH_SCALE, source_shape, None, None)
        yield name, pixels, sample_nearest(image, pixels, np.nan) / true_cameras.from_scene.scale


def replace_depth(folder: Path) -> int:
    """Write true depth into the depth maps of the run in `folder`; return how many there are."""
    crops = read_crops(folder / "04_crops/crops.zarr.zip")
    count = 0
    for name, _, exact in read_true_depths(folder):
        depth = np.where(crops.valid_of(name), exact, np.nan).astype(np.float32)
        known = np.isfinite(depth).astype(np.float32)
        path = folder / f"06_depth/{name}.zarr.zip"
        header = read_arrays(path, DEPTH_MAP)[1]
        write_depth_map(path, DepthMap(depth, 0.5 * (1 - known), known), header)
        Made(folder.parent / ".made").forget(path)  # else the job's own map would be put back
        count += 1
    (folder / "06_depth/.snakemake_timestamp").touch()  # by which Snakemake knows that a folder is new
    return count


def main() -> None:
    """Replace the depth maps of the folders named on the command line."""
    parser = argparse.ArgumentParser(description="Put true depth in the place of the depth maps of rendered takes.")
    parser.add_argument("folders", nargs="+", type=Path)
    for folder in parser.parse_args().folders:
        print(f"{folder}: {replace_depth(folder)} depth maps", flush=True)


if __name__ == "__main__":
    run_command(main)
