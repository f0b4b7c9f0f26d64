"""How the zero-crossing correction stands wrong points and wrong poses: as configured, and as printed in the paper.

    python benchmarks/jitter.py results/dragon results/books [--levels 0 0.25 0.5 1] [--plot docs/pictures/jitter.svg]

Takes the results of rendered sequences with `deformed_sdf`. Each keyframe's camera is moved at random by a share of
the longest side of the object's box; the fused field is made again with these cameras, and every surface point is moved
with those that see it and by as much on its own. Prints the F-score of the mesh before and after both corrections.
"""

from __future__ import annotations

import argparse
import io
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import yaml
from matplotlib import rc_context
from matplotlib.figure import Figure

from threedfs.evaluate.mesh_error import measure_mesh
from threedfs.evaluate.plots import COLOURS
from threedfs.io.keyframes import read_keyframes, write_keyframes
from threedfs.io.meshes import read_mesh
from threedfs.io.oriented_points import read_oriented_points, write_oriented_points
from threedfs.io.volumes import read_support
from threedfs.job import Job
from threedfs.params.deform import DeformParams
from threedfs.params.fuse_object import FuseObjectParams
from threedfs.params.locate_object import LocateObjectParams
from threedfs.params.schema import default_settings, make_params
from threedfs.progress import Progress
from threedfs.run_end.film import relate_film
from threedfs.stages import deform, fuse_object, locate_object
from threedfs.stages import object as object_stage
from threedfs.types import Keyframe, Mesh, OrientedPoints

PAPER = Path(__file__).resolve().parents[1] / "config" / "presets" / "paper.yaml"


def jitter_cameras(keyframes: Mapping[str, Keyframe], steps: np.ndarray) -> list[Keyframe]:
    """Return the keyframes with their cameras moved by steps (K, 3), world."""
    moved = []
    for keyframe, step in zip(keyframes.values(), steps, strict=True):
        pose = keyframe.view.cam_from_world.copy()
        pose[:3, 3] -= pose[:3, :3] @ step
        moved.append(replace(keyframe, view=replace(keyframe.view, cam_from_world=pose)))
    return moved


def jitter_points(points: OrientedPoints, steps: np.ndarray, deviation: float, rng: np.random.Generator):
    """Return the points moved by the mean step of the keyframes that see them, and each on its own."""
    moved = points.xyz + rng.normal(0, deviation, points.xyz.shape)
    for axis in range(3):
        total = np.bincount(points.seen_point, steps[points.seen_view, axis], len(moved))
        moved[:, axis] += total / np.maximum(points.sightings, 1)
    return replace(points, xyz=moved.astype(np.float32))


def measure(results: Path, folder: Path, level: float, corrections: Mapping[str, DeformParams]) -> list[float]:
    """Return the F-scores at 0.5 % of the fused mesh and of those after each correction, at a level of jitter, %."""
    job = Job(Progress("jitter", io.StringIO()), {}, 2, 0)
    support = results / "03_scene/support.json"
    place, rng = read_support(support), np.random.default_rng(0)
    deviation = level / 100 * place.box.longest
    keyframes = read_keyframes(results / "04_crops/keyframes.json")
    steps = rng.normal(0, deviation, (len(keyframes), 3))
    write_keyframes(folder / "keyframes.json", jitter_cameras(keyframes, steps), {})
    points, engine = read_oriented_points(results / "08_densify/points.zarr.zip")
    moved = jitter_points(points, steps, deviation, rng)
    write_oriented_points(folder / "points.zarr.zip", moved, list(keyframes), engine, {})
    maps = {name: sorted((results / name).glob("*.zarr.zip")) for name in ("04_semidense", "06_depth")}
    fuse_object.run(
        keyframes=folder / "keyframes.json",
        depth=maps["06_depth"],
        consistency=results / "07_fusion/consistency.zarr.zip",
        support=support,
        scene=results / "03_scene/volume.zarr.zip",
        volume=folder / "fused.zarr.zip",
        params=FuseObjectParams(),
        job=job,
    )
    fields = {"fused": folder / "fused.zarr.zip"}
    for name, params in corrections.items():
        fields[name] = folder / f"{name}.zarr.zip"
        deform.run(
            field=fields["fused"],
            support=support,
            cloud=folder / "points.zarr.zip",
            volume=fields[name],
            clearance=LocateObjectParams().clearance,
            noise_clearance=LocateObjectParams().noise_clearance,
            params=params,
            job=job,
        )
    truth, truth_from_scene = read_mesh(results / "00_render/mesh.ply"), relate_film(results).from_scene
    scores = []
    for name, field in fields.items():
        locate_object.run(
            volume=field,
            support=support,
            keyframes=folder / "keyframes.json",
            semidense=maps["04_semidense"],
            located=folder / "located.zarr.zip",
            field=name,
            params=LocateObjectParams(),
            job=job,
        )
        object_stage.run(
            field=field,
            located=folder / "located.zarr.zip",
            keyframes=folder / "keyframes.json",
            poses=results / "02_poses/poses.json",
            frames=results / "01_frames/frames.zarr.zip",
            mesh=folder / "mesh.ply",
            volume=folder / "alone.zarr.zip",
            silhouettes=folder / "silhouettes.zarr.zip",
            masks=folder / f"masks_{name}",
            method=name,
            job=job,
        )
        mesh = read_mesh(folder / "mesh.ply")
        aligned = Mesh(truth_from_scene.apply(mesh.vertices), mesh.faces)
        error = measure_mesh(aligned, truth, (0.5,), 50000, np.random.default_rng(0))
        scores.append(error.agreement[0].f_score)
    return scores


def draw_curves(levels: Sequence[float], scores: np.ndarray, names: Sequence[str], path: Path) -> None:
    """Draw F-scores (sequences, levels, fields) over the level of jitter: the mean, and each sequence thin."""
    figure = Figure(figsize=(4.8, 3.4), layout="constrained")
    axes = figure.subplots()
    for number, name in enumerate(names):
        axes.plot(levels, scores[:, :, number].T, color=COLOURS[number], linewidth=0.6, alpha=0.5)
        axes.plot(levels, scores[:, :, number].mean(axis=0), color=COLOURS[number], marker="o", label=name)
    axes.set_xlabel("jitter of cameras and points, % of the object's side")
    axes.set_ylabel("F-score at 0.5 %")
    axes.set_ylim(0, 1)
    axes.legend(fontsize=8, frameon=False)
    with rc_context({"svg.hashsalt": "threedfs"}):
        figure.savefig(path, format="svg", metadata={"Date": None, "Creator": None})


def main() -> None:
    """Print a line for each sequence and level, then the means."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("results", type=Path, nargs="+", help="folders of the results of sequences")
    parser.add_argument(
        "--levels", type=float, nargs="+", default=[0, 0.25, 0.5, 1], help="percent of the object's side"
    )
    parser.add_argument("--plot", type=Path, help="draw the curves into this SVG")
    options = parser.parse_args()
    printed = default_settings(DeformParams) | yaml.safe_load(PAPER.read_text())["deform"]
    corrections = {"configured": DeformParams(), "printed": make_params(DeformParams, printed)}
    names = ["fused", *corrections]
    print(f"{'sequence':>12} {'jitter, %':>10}", *(f"{name:>10}" for name in names))
    scores = np.empty((len(options.results), len(options.levels), len(names)))
    for row, results in enumerate(options.results):
        for column, level in enumerate(options.levels):
            with TemporaryDirectory(prefix="threedfs-") as folder:
                scores[row, column] = measure(results, Path(folder), level, corrections)
            _print_line(results.name, level, scores[row, column])
    for level, mean in zip(options.levels, scores.mean(axis=0), strict=True):
        _print_line("mean", level, mean)
    if options.plot is not None:
        draw_curves(options.levels, scores, names, options.plot)


def _print_line(sequence: str, level: float, scores: Sequence[float]) -> None:
    print(f"{sequence:>12} {level:10g}", *(f"{score:10.3f}" for score in scores), flush=True)


if __name__ == "__main__":
    main()
