"""How surface points lie about the true surface, and how much of it they cover.

    snakemake --cores 2 --configfile config/benchmark.yaml -- results/dragon_posed/08_densify/points.zarr.zip
    python benchmarks/points.py results/dragon_posed results/books

Takes the results of rendered sequences with surface points. The object's points are those that fall on its true mask in
at least half of the keyframes that see them. Prints their number, the median distance to the true surface and the share
within 1 %, and the share of the visible true surface that has a point within 1 %, all of the object's diagonal. Visible
is what at least one keyframe sees.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from threedfs.evaluate.mesh_error import bounding_diagonal
from threedfs.evaluate.rendering import sample_nearest
from threedfs.evaluate.surface import SurfaceDistance, sample_surface
from threedfs.evaluate.true_cameras import Filmed
from threedfs.frames.masks import find_masks
from threedfs.geometry.lens import Lens
from threedfs.geometry.projection import inside
from threedfs.geometry.raycast import RayCaster
from threedfs.io.images import read_mask
from threedfs.io.keyframes import read_keyframes
from threedfs.io.meshes import read_mesh
from threedfs.io.oriented_points import read_oriented_points
from threedfs.run_end.film import find_film, relate_film
from threedfs.types import Mesh, OrientedPoints

_NEAR = 0.01
"""Share of the object's diagonal within which a point and the surface belong together."""

_SAMPLES = 50000

_HIDDEN = 1e-4
"""Relative difference in depth up to which a ray has met the sample that it was sent to."""


def find_object_points(
    points: OrientedPoints, xyz: np.ndarray, filmed: list[Filmed], masks: list[np.ndarray]
) -> np.ndarray:
    """Return (N,) bool, the points that fall on the true mask in at least half of the keyframes that see them.

    Parameters
    ----------
    points : OrientedPoints
    xyz : (N, 3) float64
        The points in the world of the true cameras.
    filmed, masks : list
        True camera and mask of every keyframe.
    """
    on_object = np.zeros(len(xyz))
    for rank, ((view, distortion), mask) in enumerate(zip(filmed, masks, strict=True)):
        seen = points.seen_point[points.seen_view == rank]
        in_camera = xyz[seen] @ view.cam_from_world[:3, :3].T + view.cam_from_world[:3, 3]
        pixels = Lens(view.camera, *distortion).denormalise(in_camera[:, :2] / in_camera[:, 2:])
        np.add.at(on_object, seen, sample_nearest(mask, pixels, False))
    return 2 * on_object >= np.maximum(points.sightings, 1)


def find_visible(mesh: Mesh, samples: np.ndarray, filmed: list[Filmed]) -> np.ndarray:
    """Return (S,) bool, the samples (S, 3) on a mesh that at least one camera sees."""
    caster, visible = RayCaster(mesh), np.zeros(len(samples), bool)
    for view, distortion in filmed:
        rotation, translation = view.cam_from_world[:3, :3], view.cam_from_world[:3, 3]
        in_camera = samples @ rotation.T + translation
        pixels = Lens(view.camera, *distortion).denormalise(in_camera[:, :2] / in_camera[:, 2:])
        rays = samples + rotation.T @ translation
        hits = caster.first_hits(np.broadcast_to(-rotation.T @ translation, rays.shape), rays)
        visible |= inside(view.camera, pixels) & (in_camera[:, 2] > 0) & (hits.distance > 1 - _HIDDEN)
    return visible


def measure(results: Path) -> tuple[int, float, float, float]:
    """Return the number of points on the object, their median distance, the share near, and the share covered."""
    truth, mesh = relate_film(results), read_mesh(find_film(results) / "mesh.ply")
    points, _ = read_oriented_points(results / "08_densify/points.zarr.zip")
    names = list(read_keyframes(results / "03_keyframes/keyframes.json"))
    files = find_masks(find_film(results) / "masks", names, numbered=True)
    xyz = truth.from_scene.apply(points.xyz.astype(np.float64))
    filmed = [truth.seen[name] for name in names]
    on_object = xyz[find_object_points(points, xyz, filmed, [read_mask(files[name]) for name in names])]
    samples, face = sample_surface(mesh, _SAMPLES, np.random.default_rng(0))
    reach = _NEAR * bounding_diagonal(mesh)
    distance = SurfaceDistance(mesh, samples, face)(on_object)
    visible = samples[find_visible(mesh, samples, filmed)]
    covered = cKDTree(on_object).query(visible)[0] <= reach
    return len(on_object), float(np.median(distance)) / reach * _NEAR, (distance <= reach).mean(), covered.mean()


def main() -> None:
    """Print a line for each sequence."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("results", type=Path, nargs="+", help="folders of the results of sequences")
    print(f"{'sequence':>20} {'points':>8} {'median, %':>10} {'near, %':>8} {'covered, %':>11}")
    for results in parser.parse_args().results:
        count, median, near, covered = measure(results)
        print(f"{results.name:>20} {count:8d} {100 * median:10.2f} {100 * near:8.1f} {100 * covered:11.1f}", flush=True)


if __name__ == "__main__":
    main()
