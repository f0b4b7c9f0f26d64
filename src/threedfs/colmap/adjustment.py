"""Bundle adjustment of poses, points and one lens."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pycolmap

from threedfs.colmap.graph import image_id
from threedfs.colmap.lens import colmap_from_px, make_colmap_camera, make_simple_camera, read_colmap_camera
from threedfs.geometry.lens import Lens

_ITERATIONS = 20
_TOLERANCE = 1e-5  # relative change of the sum of squares


def adjust_bundle(
    lenses: Mapping[int, Lens],
    cam_from_world: Mapping[int, np.ndarray],
    xyz: np.ndarray,
    track_point: np.ndarray,
    track_frame: np.ndarray,
    pixels: np.ndarray,
    *,
    loss_width: float,
    refine_poses: bool,
    refine_lens: bool,
) -> tuple[dict[int, Lens], dict[int, np.ndarray], np.ndarray]:
    """Find the poses, points and lens at which observations are best explained, on one thread.

    Parameters
    ----------
    lenses, cam_from_world : mapping
        Lens and (4, 4) float64 pose by frame number. A lens to refine is one that all share, without k2.
    xyz : (N, 3) float64
    track_point, track_frame : (M,) int64
        Index of the point, ascending, and number of the frame of each observation.
    pixels : (M, 2) float64
    loss_width : float
        Errors above count less than their square (soft L1), pixels.
    refine_poses, refine_lens : bool
        Whether they are changed, or points only.

    Returns
    -------
    lenses, cam_from_world, xyz
        As given.
    """
    model = pycolmap.Reconstruction()
    cameras = {lens: number for number, lens in enumerate(dict.fromkeys(lenses.values()), 1)}
    for lens, number in cameras.items():
        camera = make_simple_camera(lens, number) if refine_lens else make_colmap_camera(lens, number)
        model.add_camera_with_trivial_rig(camera)
    place = np.zeros(len(track_frame), np.int64)
    for frame, pose in cam_from_world.items():
        here = np.flatnonzero(track_frame == frame)
        place[here] = np.arange(len(here))
        image = pycolmap.Image(
            name=f"{frame:06d}",
            keypoints=colmap_from_px(pixels[here]),
            camera_id=cameras[lenses[frame]],
            image_id=image_id(frame),
        )
        model.add_image_with_trivial_frame(image, pycolmap.Rigid3d(pose[:3]))
    starts = np.searchsorted(track_point, np.arange(len(xyz) + 1))
    images, places = (track_frame + image_id(0)).tolist(), place.tolist()
    numbers = [
        model.add_point3D(point, pycolmap.Track(list(map(pycolmap.TrackElement, images[a:b], places[a:b]))))
        for point, a, b in zip(xyz, starts[:-1], starts[1:], strict=True)
    ]
    _solve(model, loss_width, refine_poses, refine_lens)
    poses = {}
    for frame in cam_from_world:
        poses[frame] = np.eye(4)
        poses[frame][:3] = model.image(image_id(frame)).cam_from_world().matrix()
    solved = {number: read_colmap_camera(model.cameras[number]) for number in cameras.values()}
    return (
        {frame: solved[cameras[lens]] for frame, lens in lenses.items()} if refine_lens else dict(lenses),
        poses if refine_poses else dict(cam_from_world),
        np.array([model.point3D(number).xyz for number in numbers]).reshape(-1, 3),
    )


def _solve(model: pycolmap.Reconstruction, loss_width: float, refine_poses: bool, refine_lens: bool) -> None:
    options = pycolmap.BundleAdjustmentOptions(
        refine_focal_length=refine_lens,
        refine_extra_params=refine_lens,
        refine_rig_from_world=refine_poses,
        print_summary=False,
    )
    options.ceres.loss_function_type = pycolmap.LossFunctionType.SOFT_L1
    options.ceres.loss_function_scale = loss_width
    options.ceres.solver_options.num_threads = 1
    options.ceres.solver_options.max_num_iterations = _ITERATIONS
    options.ceres.solver_options.function_tolerance = _TOLERANCE
    config = pycolmap.BundleAdjustmentConfig()
    for identity in model.reg_image_ids():
        config.add_image(identity)
    if refine_poses:
        config.fix_gauge(pycolmap.BundleAdjustmentGauge.TWO_CAMS_FROM_WORLD)
    pycolmap.create_default_bundle_adjuster(options, config, model).solve()
