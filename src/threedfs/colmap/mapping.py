"""Incremental structure from motion with bundle adjustment."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import pycolmap

from threedfs.colmap.graph import Matches, write_graph
from threedfs.colmap.lens import guess_colmap_camera, make_colmap_camera, read_colmap_camera
from threedfs.colmap.model import Model, read_model
from threedfs.geometry.lens import Lens
from threedfs.types import Features


@dataclass(frozen=True)
class Mapped:
    """What the mapper made of one sequence.

    Attributes
    ----------
    model : Model
        The largest connected part.
    lens : Lens
        The camera that all frames share, as given or self-calibrated.
    parts : tuple of int
        Frames in every connected part, the largest first.
    reconstruction : pycolmap.Reconstruction
        The same as COLMAP holds it, to go on from.
    """

    model: Model
    lens: Lens
    parts: tuple[int, ...]
    reconstruction: pycolmap.Reconstruction


def map_frames(
    features: Sequence[Features],
    matches: Matches,
    *,
    width: int,
    height: int,
    lens: Lens | None,
    focal_factor: float,
    min_inliers: int,
    min_inlier_share: float,
    seed: int,
    start: Mapped | None = None,
) -> Mapped | None:
    """Estimate the poses of frames taken with one camera.

    The mapper works on one thread: with more its sums, and so its last bits, would depend on their number.

    Parameters
    ----------
    features : sequence of Features
    matches : mapping
        Verified matches by pair of frame numbers.
    width, height : int
        Of the frames.
    lens : Lens or None
        Known intrinsics, kept as they are; without them a focal length and k1 are estimated.
    focal_factor : float
        First guess of the focal length, in longest sides of the image.
    min_inliers, min_inlier_share : int, float
        Least support by known points for the pose of a frame to be believed, at the second try; the first asks for
        COLMAP's own (30, 0.25).
    seed : int
    start : Mapped, optional
        Go on from this: its tracks are completed and merged by the matches, missing frames are registered, and all is
        adjusted. Much faster than from nothing.

    Returns
    -------
    Mapped or None
        None if no two frames gave a start.
    """
    camera = guess_colmap_camera(width, height, focal_factor, 1) if lens is None else make_colmap_camera(lens, 1)
    with TemporaryDirectory(prefix="threedfs-") as folder:
        database = Path(folder) / "graph.db"
        write_graph(database, [camera], features, matches, verified=True)
        options = _options(seed, refine=lens is None)
        parts = _run(database, Path(folder) / "first", options, start.reconstruction if start else None)
        if not parts:
            return None
        best = parts[0]
        if best.num_reg_images() < len(features):
            options.mapper.abs_pose_min_num_inliers = min_inliers
            options.mapper.abs_pose_min_inlier_ratio = min_inlier_share
            again = _run(database, Path(folder) / "second", options, best)
            if again and again[0].num_reg_images() > best.num_reg_images():
                best = again[0]
        sizes = (best.num_reg_images(), *(part.num_reg_images() for part in parts[1:]))
        return Mapped(read_model(best, features), read_colmap_camera(best.cameras[1]), sizes, best)


def _options(seed: int, refine: bool) -> pycolmap.IncrementalPipelineOptions:
    options = pycolmap.IncrementalPipelineOptions(
        num_threads=1,
        random_seed=seed,
        extract_colors=False,
        ba_refine_focal_length=refine,
        ba_refine_extra_params=refine,
        ba_refine_principal_point=False,
    )
    options.mapper.num_threads = 1
    options.mapper.random_seed = seed
    options.mapper.abs_pose_refine_focal_length = refine
    options.mapper.abs_pose_refine_extra_params = refine
    options.triangulation.random_seed = seed
    return options


def _run(
    database: Path,
    folder: Path,
    options: pycolmap.IncrementalPipelineOptions,
    start: pycolmap.Reconstruction | None,
) -> list[pycolmap.Reconstruction]:
    (folder / "start").mkdir(parents=True)
    options.multiple_models = start is None
    if start is not None:
        start.write(folder / "start")
    found = pycolmap.incremental_mapping(
        database, folder, folder, options, input_path=folder / "start" if start else ""
    )
    return sorted(found.values(), key=lambda part: -part.num_reg_images())
