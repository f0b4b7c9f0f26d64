"""Cuts of the images by colour with one thing exact at a time, to see what stands between them and true masks.

    python benchmarks/exact_cuts.py results/NAME [results/NAME ...] [--change KEY=VALUE ... [--together]]

Takes a finished run of a rendered take with `keyframes_at_truth: true`, fused_sdf, gc_2d and gc_2d3d_pixel. Cuts its
images again, alone (2D GC of Section 4.3) and jointly with the voxels, with the run's own settings: as it is; with
superpixels split where they straddle the true outline; with colours learnt in every round from true masks; with both.
Prints the mean IoU over the keyframes, in crops, of the pixels and of the labelled voxels' outline (gc_2d3d_voxel),
beside the best that the superpixels allow and the outline of the fused field. With changes to settings of `segment`
it prints the IoU as it is and with these instead, each alone or all together. Beside the values of the setting, `roi`
can be `region`: what the scene's fusion takes for the region of interest, in the place of the object's box.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Iterable, Mapping
from contextlib import nullcontext
from pathlib import Path
from types import MappingProxyType
from typing import Any
from unittest.mock import patch

import numpy as np
import yaml
from command import run_command
from exact_depth import find_filmed_pixels

from threedfs.evaluate.masks import intersection_over_union
from threedfs.evaluate.rendering import sample_nearest
from threedfs.io.arrays import read_arrays
from threedfs.io.crops import read_crops
from threedfs.io.depth_maps import read_edges
from threedfs.io.images import read_mask
from threedfs.io.keyframes import read_keyframes
from threedfs.io.segmentation import SEGMENTATION, Segmentation, read_segmentation
from threedfs.io.superpixels import read_superpixels, write_superpixels
from threedfs.io.volumes import read_silhouettes, read_volume
from threedfs.job import Job
from threedfs.object.silhouettes import draw_silhouette
from threedfs.params.schema import make_params
from threedfs.params.segment import SegmentParams
from threedfs.progress import Progress
from threedfs.run_end.film import find_film
from threedfs.segment import gather, joint
from threedfs.segment.energy import BACKGROUND, OBJECT
from threedfs.segment.gather import box_of_grid
from threedfs.segment.outline import surround_voxels
from threedfs.segment.superpixels import Superpixels, join_superpixels
from threedfs.stages import segment

_FIELDS = {"fused": "07_fusion/object.zarr.zip", "deformed": "09_deform/volume.zarr.zip"}


def read_true_masks(folder: Path) -> dict[str, np.ndarray]:
    """Return the true masks (H, W) bool of all keyframes, in their crops."""
    valid, masks = read_crops(folder / "04_crops/crops.zarr.zip").valid_of, find_film(folder) / "masks"
    return {
        name: sample_nearest(read_mask(masks / f"{name}.png"), pixels, False) & valid(name)
        for name, pixels in find_filmed_pixels(folder).items()
    }


def split_at(superpixels: Superpixels, mask: np.ndarray, strength: np.ndarray) -> Superpixels:
    """Return superpixels of which none straddles the outline of a mask (H, W)."""
    index = np.where(superpixels.index >= 0, 2 * superpixels.index + mask, -1)
    kept, rank = np.unique(index, return_inverse=True)
    return join_superpixels((rank.reshape(index.shape) - (kept[0] < 0)).astype(np.int32), strength)


def cut_anew(
    folder: Path,
    cut: str,
    superpixels: Path,
    truth: Mapping[str, np.ndarray] | None = None,
    changes: Mapping[str, Any] = MappingProxyType({}),
) -> Segmentation:
    """Cut anew, with superpixels of a folder, colours of true masks if any, and changed settings."""
    params = read_arrays(folder / f"10_segment/{cut}.zarr.zip", SEGMENTATION)[1]["parameters"] | changes
    learn, in_region = joint._learn_colors, nullcontext()
    if params["roi"] == "region":
        region = box_of_grid(read_volume(folder / "03_scene/volume.zarr.zip").grid)
        params["roi"], in_region = "grid", patch.object(gather, "box_of_grid", return_value=region)

    def learn_from_truth(images, labels, *others):
        exact = {name: images[name].superpixels.share(truth[name]) > 0.5 for name in labels}
        return learn(images, {name: np.where(own, OBJECT, BACKGROUND) for name, own in exact.items()}, *others)

    field = params["field"]
    with (
        tempfile.TemporaryDirectory() as scratch,
        patch.object(joint, "_learn_colors", learn_from_truth if truth else learn),
        in_region,
    ):
        segment.run(
            field=folder / _FIELDS[field],
            located=folder / f"07_fusion/located/{field}_sdf.zarr.zip",
            support=folder / "03_scene/support.json",
            keyframes=folder / "04_crops/keyframes.json",
            crops=folder / "04_crops/crops.zarr.zip",
            superpixels=sorted(superpixels.glob("*.zarr.zip")),
            semidense=sorted((folder / "04_semidense").glob("*.zarr.zip")),
            depth=sorted((folder / "06_depth").glob("*.zarr.zip")),
            consistency=folder / "07_fusion/consistency.zarr.zip",
            labels=Path(scratch) / "labels.zarr.zip",
            appearance=Path(scratch) / "appearance.zarr.zip",
            cut=cut,
            params=make_params(SegmentParams, params),
            job=Job(Progress(cut), {}, 1, 0),
        )
        return read_segmentation(Path(scratch) / "labels.zarr.zip")


def draw_voxels(folder: Path, labelled: Segmentation) -> dict[str, np.ndarray]:
    """Return the outlines (H, W) bool of the object's voxels in the crops of the keyframes."""
    surface = surround_voxels(labelled.voxels == OBJECT, labelled.grid)
    entries = read_keyframes(folder / "04_crops/keyframes.json")
    return {name: draw_silhouette(surface, entry.view) for name, entry in entries.items()}


def mean_iou(masks: Mapping[str, np.ndarray], truth: Mapping[str, np.ndarray]) -> float:
    """Return the mean IoU over all keyframes."""
    return float(np.mean([intersection_over_union(masks[name], own) for name, own in truth.items()]))


def measure_cut(
    folder: Path, cut: str, labelled: Segmentation, truth: Mapping[str, np.ndarray], made: str
) -> dict[str, float]:
    """Return the mean IoU of a cut's pixels and, of the joint one, of its voxels' outline, under names that end so."""
    found = {cut + made: mean_iou(labelled.masks, truth)}
    if cut == "joint":
        found["voxels" + made] = mean_iou(draw_voxels(folder, labelled), truth)
    return found


def read_settings(changes: Iterable[str]) -> dict[str, Any]:
    """Return the settings that changes, KEY=VALUE each, name."""
    return {key: yaml.safe_load(value) for key, _, value in (change.partition("=") for change in changes)}


def measure_changes(folder: Path, changes: list[str], together: bool) -> dict[str, float]:
    """Return the IoU of both cuts and of the voxels as they are, and with each change alone, or with all of them."""
    truth, found = read_true_masks(folder), {}
    for made in [[], changes] if together else [[], *([change] for change in changes)]:
        settings = read_settings(made)
        for cut in ("images", "joint"):
            labelled = cut_anew(folder, cut, folder / "10_segment/superpixels", None, settings)
            found |= measure_cut(folder, cut, labelled, truth, "".join(f" {change}" for change in made))
    return found


def measure(folder: Path) -> dict[str, float]:
    """Return the IoU of both cuts and of the voxels with nothing, superpixels, colours, and both exact."""
    truth = read_true_masks(folder)
    given = folder / "10_segment/superpixels"
    found, best = {}, {}
    with tempfile.TemporaryDirectory() as scratch:
        for name, own in truth.items():
            superpixels = read_superpixels(given / f"{name}.zarr.zip")
            best[name] = superpixels.paint(superpixels.share(own) > 0.5)
            exact = split_at(superpixels, own, read_edges(folder / f"05_edges/{name}.zarr.zip"))
            write_superpixels(Path(scratch) / f"{name}.zarr.zip", exact, {})
        found["best labels"] = mean_iou(best, truth)
        fused = read_silhouettes(folder / "11_object/fused_sdf/silhouettes.zarr.zip")
        found["fused field"] = mean_iou(fused, truth)
        for cut in ("images", "joint"):
            for what, where, known in (
                ("", given, None),
                (", superpixels", Path(scratch), None),
                (", colours", given, truth),
                (", both", Path(scratch), truth),
            ):
                found |= measure_cut(folder, cut, cut_anew(folder, cut, where, known), truth, what)
    return found


def main() -> None:
    """Print a line for each folder named on the command line."""
    parser = argparse.ArgumentParser(description="Cut images by colour with one thing exact at a time.")
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--change", nargs="+", default=[], metavar="KEY=VALUE")
    parser.add_argument("--together", action="store_true", help="make all changes at once")
    given = parser.parse_args()
    if given.together and not given.change:
        parser.error("--together: expected --change with what is to change at once, got none")
    for change in given.change:
        if change.partition("=")[0] not in vars(SegmentParams()) or "=" not in change:
            parser.error(f"--change: expected a parameter of segment and its value, KEY=VALUE, got {change}")
    for folder in given.folders:
        found = measure_changes(folder, given.change, given.together) if given.change else measure(folder)
        print(folder.name, {what: round(value, 3) for what, value in found.items()}, flush=True)


if __name__ == "__main__":
    run_command(main)
