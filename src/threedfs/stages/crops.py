"""Crops of the source's frames around the object, each keyframe and its neighbours."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from threedfs.crops.depth_range import expect_crop_range
from threedfs.crops.place import find_window, measure_object, place_crops, shrink_view
from threedfs.crops.resample import resample
from threedfs.errors import UserError
from threedfs.frames.decode import scan_source
from threedfs.frames.scale import scale_camera
from threedfs.geometry.lens import Lens
from threedfs.io.crops import Crop, write_crops
from threedfs.io.keyframes import read_keyframes, read_needs_stereo, write_keyframes
from threedfs.io.points import read_points
from threedfs.io.poses import read_poses
from threedfs.io.volumes import read_support
from threedfs.job import Job
from threedfs.params.crops import CropsParams
from threedfs.read_ahead import read_ahead


def run(
    *,
    source: Path,
    poses: Path,
    points: Path,
    keyframes: Path,
    support: Path | None,
    crops: Path,
    views: Path,
    frame_far_factor: float,
    params: CropsParams,
    job: Job,
) -> None:
    """Read the source again; write crops.zarr.zip and the keyframes as views of them.

    Without the place of an object, or if `crops.whole` is set, frames are taken whole. `frame_far_factor` is what the
    stage keyframes multiplied the far end of its ranges with.

    Raises
    ------
    UserError
        If the source is missing.
    """
    scanned = scan_source(source, job.progress)
    posed, entries = read_poses(poses), read_keyframes(keyframes)
    wanted = {view.name for entry in entries.values() for view in (entry.view, *entry.neighbours)}
    filmed = [
        replace(view, camera=scale_camera(view.camera, scanned.shape, f"frame {view.name}"))
        for view in posed.views
        if view.name in wanted
    ]
    corners = None if support is None or params.whole else read_support(support).box.corners()
    if corners is None:
        placed = [shrink_view(view, params.longest_side) for view in filmed]
    else:
        placed = place_crops(filmed, corners, params.margin, params.pixels)
    of_frame = {view.name: (view, crop) for view, crop in zip(filmed, placed, strict=True)}

    def cut():
        pictures = read_ahead(
            (picture for picture in scanned.pictures() if picture.name in of_frame), threads=job.threads
        )
        for picture in job.progress.track(pictures, "crop", len(of_frame)):
            view, crop = of_frame[picture.name]
            image = picture.load()
            if image is None:
                raise UserError(
                    f"{source}: expected to decode {picture.name} as before, found that it no longer can be; "
                    "leave the source as it is during a run, and run again."
                )
            yield Crop(picture.name, *resample(image, Lens(view.camera, *posed.distortion), crop.camera))

    write_crops(
        crops, read_ahead(cut(), threads=job.threads), job.header, ordered=scanned.ordered, source_shape=scanned.shape
    )
    moved = []
    xyz = read_points(points).xyz
    for entry in entries.values():
        neighbours = tuple(of_frame[neighbour.name][1] for neighbour in entry.neighbours)
        seen = replace(entry, view=of_frame[entry.view.name][1], neighbours=neighbours)
        if corners is not None and find_window(of_frame[entry.view.name][0], corners, params.margin):
            factors = (params.near_factor, params.far_factor, frame_far_factor)
            seen = expect_crop_range(seen, xyz, corners, *factors)
        moved.append(seen)
    length = None if corners is None else measure_object(placed, corners)
    write_keyframes(views, moved, job.header, needs_stereo=read_needs_stereo(keyframes), object_pixels=length)
    area = sum(view.camera.width * view.camera.height for view in placed) / len(placed)
    share = sum(c.camera.fx / v.camera.fx for v, c in zip(filmed, placed, strict=True)) / len(placed)
    job.progress.note(f"{len(placed)} crops of {area:.0f} pixels on average, at {share:.2f} of the source's resolution")
