"""The object's mesh, volume, silhouettes and masks from its field."""

from __future__ import annotations

from pathlib import Path

from threedfs.io.frames import read_frames
from threedfs.io.keyframes import read_keyframes
from threedfs.io.located import read_located
from threedfs.io.meshes import write_mesh
from threedfs.io.outlines import write_outlines
from threedfs.io.poses import read_poses
from threedfs.io.volumes import Volume, read_volume, write_volume
from threedfs.job import Job
from threedfs.object.extract import extract_surface
from threedfs.object.field import mask_field


def run(
    *,
    field: Path,
    located: Path,
    keyframes: Path,
    poses: Path,
    frames: Path,
    mesh: Path,
    volume: Path,
    silhouettes: Path,
    masks: Path,
    method: str,
    job: Job,
) -> None:
    """Read the field on the object's grid, and where the object is in it; write it alone as mesh, volume and masks."""
    fused, place = read_volume(field), read_located(located)
    alone = mask_field(fused.sdf, place.voxels, place.height, fused.grid.spacing)
    surface = extract_surface(alone, fused.grid)
    job.progress.note(f"{method}: {len(surface.faces)} triangles")
    write_mesh(mesh, surface)
    write_volume(volume, Volume(fused.grid, alone, fused.seen), job.header)
    views = [entry.view for entry in read_keyframes(keyframes).values()]
    posed, source_shape = read_poses(poses), read_frames(frames).source_shape
    whole = {view.name: view for view in posed.views}
    write_outlines(silhouettes, masks, surface, views, whole, posed.distortion, source_shape, job.header)
