"""The object's mesh from surface points alone: the baseline of multi-view stereo and Poisson reconstruction."""

from __future__ import annotations

from pathlib import Path

from threedfs.colmap.poisson import mesh_points
from threedfs.densify.crop import crop_points
from threedfs.io.frames import read_frames
from threedfs.io.keyframes import read_keyframes
from threedfs.io.meshes import write_mesh
from threedfs.io.oriented_points import read_oriented_points
from threedfs.io.outlines import write_outlines
from threedfs.io.poses import read_poses
from threedfs.io.volumes import read_support
from threedfs.job import Job
from threedfs.object.extract import keep_largest_shell
from threedfs.params.poisson import PoissonParams


def run(
    *,
    cloud: Path,
    support: Path,
    keyframes: Path,
    poses: Path,
    frames: Path,
    mesh: Path,
    silhouettes: Path,
    masks: Path,
    params: PoissonParams,
    job: Job,
) -> None:
    """Read the points; write the mesh of those on the object, and its masks."""
    place = read_support(support)
    clearance = params.clearance * place.box.longest
    found, _ = read_oriented_points(cloud)
    points = crop_points(found, place.box, place.plane, clearance, params.min_sightings)
    surface = keep_largest_shell(mesh_points(points, params.octree_depth))
    job.progress.note(f"{len(points.xyz)} points, {len(surface.faces)} triangles")
    write_mesh(mesh, surface)
    views = [entry.view for entry in read_keyframes(keyframes).values()]
    posed, source_shape = read_poses(poses), read_frames(frames).source_shape
    whole = {view.name: view for view in posed.views}
    write_outlines(silhouettes, masks, surface, views, whole, posed.distortion, source_shape, job.header)
