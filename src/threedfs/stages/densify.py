"""Oriented surface points of the object from patches that match."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from threedfs.colmap.workspace import FusionRule, fuse_workspace, match_on_gpu, write_patch_map, write_workspace
from threedfs.densify.engine import choose_engine
from threedfs.densify.normals import patch_normals
from threedfs.densify.tracks import list_tracks
from threedfs.io.crops import read_crops
from threedfs.io.depth_maps import read_stereo
from threedfs.io.keyframes import read_keyframes
from threedfs.io.oriented_points import write_oriented_points
from threedfs.io.points import read_points
from threedfs.io.poses import read_poses
from threedfs.io.volumes import read_support
from threedfs.job import Job
from threedfs.params.densify import DensifyParams
from threedfs.params.rules import make_rule
from threedfs.types import OrientedPoints


def run(
    *,
    crops: Path,
    keyframes: Path,
    poses: Path,
    points: Path,
    support: Path,
    stereo: list[Path] | None,
    cloud: Path,
    cuda: bool,
    params: DensifyParams,
    job: Job,
) -> None:
    """Read the keyframes and their patches, or match patches on the GPU; write the points in the object's box.

    Differs from the paper: slanted patches merged by COLMAP in place of PMVS (3.3.2), and only in the object's box.
    """
    views = [entry.view for entry in read_keyframes(keyframes).values()]
    engine = choose_engine(params.points, params.engine, cuda)
    if engine == "off":
        found = _nothing()
    else:
        frames = read_crops(crops)
        numbers = {view.name: number for number, view in enumerate(read_poses(poses).views)}
        tracks = list_tracks(read_points(points), [numbers[view.name] for view in views])
        with TemporaryDirectory(prefix="threedfs-") as folder:
            workspace = Path(folder)
            write_workspace(workspace, views, frames.image, tracks)
            if engine == "cuda":
                match_on_gpu(workspace, params.window_radius)
            else:
                paths = {path.name.removesuffix(".zarr.zip"): path for path in stereo or []}
                for view in job.progress.track(views, "keyframe"):
                    patches = read_stereo(paths[view.name])
                    kept = np.where(patches.cost <= params.max_cost, patches.inverse_depth, np.nan)
                    normal = patch_normals(view.camera, kept, patches.slope)
                    write_patch_map(workspace, view, 1 / kept, normal)
            rule = make_rule(FusionRule, params)
            found = fuse_workspace(workspace, rule, read_support(support).box)
    job.progress.note(f"{len(found.xyz)} surface points ({engine})")
    write_oriented_points(cloud, found, [view.name for view in views], engine, job.header)


def _nothing() -> OrientedPoints:
    vectors, numbers = np.zeros((0, 3), np.float32), np.zeros(0, np.int64)
    return OrientedPoints(vectors, vectors, np.zeros((0, 3), np.uint8), numbers, numbers)
