"""Geometric verification: of the matches of two frames, those that one geometry explains."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pycolmap

from threedfs.colmap.graph import Matches, frame_number, write_graph
from threedfs.colmap.lens import guess_colmap_camera, make_colmap_camera
from threedfs.geometry.lens import Lens
from threedfs.types import Features

_FLAT = {
    kind.value
    for kind in (
        pycolmap.TwoViewGeometryConfiguration.PLANAR,
        pycolmap.TwoViewGeometryConfiguration.PANORAMIC,
        pycolmap.TwoViewGeometryConfiguration.PLANAR_OR_PANORAMIC,
    )
}


@dataclass(frozen=True)
class Verified:
    """The matches of a pair that one geometry explains.

    Attributes
    ----------
    matches : (M, 2) uint32
        Keypoint indices.
    second_from_first : (4, 4) float64 or None
        Relative pose, its translation without scale; None if the lens is unknown or the matches leave it open.
    flat : bool
        One homography explains the matches as well as an epipolar geometry does: no parallax.
    """

    matches: np.ndarray
    second_from_first: np.ndarray | None
    flat: bool = False


def verify_matches(
    features: Sequence[Features],
    matches: Matches,
    *,
    width: int,
    height: int,
    lens: Lens | None,
    focal_factor: float,
    max_error: float,
    seed: int,
    threads: int,
) -> dict[tuple[int, int], Verified]:
    """Keep of each pair's matches those that agree with one epipolar geometry or homography.

    Parameters
    ----------
    features : sequence of Features
    matches : mapping
        By pair of frame numbers.
    width, height : int
        Of the frames.
    lens : Lens or None
        With it an essential matrix and the relative pose are estimated, without it a fundamental matrix.
    focal_factor : float
        First guess of the focal length, in longest sides of the image; without `lens` only.
    max_error : float
        Pixels.
    seed : int
        Of the random samples, set anew for each pair: the result does not depend on order or threads.
    threads : int

    Returns
    -------
    dict
        `Verified` by pair of frame numbers; pairs without support are absent.
    """
    camera = guess_colmap_camera(width, height, focal_factor, 1) if lens is None else make_colmap_camera(lens, 1)
    options = pycolmap.TwoViewGeometryOptions()
    options.ransac.max_error = max_error
    options.ransac.random_seed = seed
    options.compute_relative_pose = lens is not None
    with TemporaryDirectory(prefix="threedfs-") as folder:
        path = Path(folder) / "graph.db"
        write_graph(path, [camera], features, matches, verified=False)
        pycolmap.geometric_verification(
            path, pycolmap.GeometricVerifierOptions(num_threads=threads), two_view_geometry_options=options
        )
        with pycolmap.Database.open(path) as database:
            identities, geometries = database.read_two_view_geometries()
    verified = {}
    for identity, geometry in zip(identities, geometries, strict=True):
        first, second = (frame_number(image) for image in pycolmap.pair_id_to_image_pair(identity))
        if len(geometry.inlier_matches):
            verified[first, second] = Verified(
                np.array(geometry.inlier_matches, np.uint32), _relative_pose(geometry), geometry.config in _FLAT
            )
    return dict(sorted(verified.items()))


def _relative_pose(geometry: pycolmap.TwoViewGeometry) -> np.ndarray | None:
    if geometry.cam2_from_cam1 is None:
        return None
    pose = np.eye(4)
    pose[:3] = geometry.cam2_from_cam1.matrix()
    return pose if np.linalg.norm(pose[:3, 3]) > 0 else None
