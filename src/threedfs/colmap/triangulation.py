"""Points from known cameras."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pycolmap

from threedfs.colmap.graph import Matches, image_id, write_graph
from threedfs.colmap.lens import make_colmap_camera
from threedfs.colmap.model import Model, read_model
from threedfs.geometry.lens import Lens
from threedfs.types import Features


def triangulate(
    features: Sequence[Features],
    matches: Matches,
    lenses: Mapping[int, Lens],
    cam_from_world: Mapping[int, np.ndarray],
    *,
    seed: int,
) -> Model:
    """Triangulate the matches with poses and intrinsics as given.

    Parameters
    ----------
    features : sequence of Features
        Of every frame; frames without a pose are left out.
    matches : mapping
        Matches by pair of frame numbers that agree with the epipolar geometry of the poses.
    lenses, cam_from_world : mapping
        Lens and (4, 4) float64 pose by frame number.
    seed : int
    """
    unused = next(iter(lenses.values()))
    cameras = [make_colmap_camera(lenses.get(number, unused), image_id(number)) for number in range(len(features))]
    with TemporaryDirectory(prefix="threedfs-") as folder:
        database_path = Path(folder) / "graph.db"
        output = Path(folder) / "points"
        output.mkdir()
        write_graph(database_path, cameras, features, matches, verified=True)
        posed = pycolmap.Reconstruction()
        with pycolmap.Database.open(database_path) as database:
            for rig, camera in zip(database.read_all_rigs(), database.read_all_cameras(), strict=True):
                posed.add_camera(camera)
                posed.add_rig(rig)
            for number, pose in cam_from_world.items():
                frame = database.read_frame(image_id(number))
                frame.rig_from_world = pycolmap.Rigid3d(pose[:3])
                posed.add_frame(frame)
                posed.add_image(database.read_image(image_id(number)))
                posed.register_frame(frame.frame_id)
        options = pycolmap.IncrementalPipelineOptions(num_threads=1, random_seed=seed, extract_colors=False)
        options.triangulation.ignore_two_view_tracks = False
        options.mapper.num_threads = 1
        options.triangulation.random_seed = seed
        found = pycolmap.triangulate_points(posed, database_path, output, output, options=options)
    return read_model(found, features)
