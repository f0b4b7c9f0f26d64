"""SIFT keypoints and descriptors of all frames."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from tempfile import TemporaryDirectory

import cv2
import numpy as np
import pycolmap

from threedfs.colmap.lens import px_from_colmap
from threedfs.types import Features


def extract_features(
    images: Iterable[np.ndarray],
    *,
    max_features: int,
    min_contrast: float,
    threads: int,
) -> list[Features]:
    """Extract SIFT features.

    One image is worked on by one thread, so that the result does not depend on their number.

    Parameters
    ----------
    images : iterable of (H, W, 3) uint8 RGB
        Read once, one at a time; all of one size.
    max_features : int
        Most keypoints kept of a frame, the largest scales first.
    min_contrast : float
        Least contrast of a keypoint (SIFT's peak threshold), of the grey range.
    threads : int
        Images worked on at the same time.
    """
    with TemporaryDirectory(prefix="threedfs-") as folder:
        names = []
        picture_folder = Path(folder) / "images"
        picture_folder.mkdir()
        for number, image in enumerate(images):
            names.append(f"{number:06d}.bmp")  # uncompressed: written and read again in no time
            cv2.imwrite(str(picture_folder / names[-1]), np.ascontiguousarray(image[..., ::-1]))
        options = pycolmap.FeatureExtractionOptions(num_threads=threads, use_gpu=False)
        options.sift.max_num_features = max_features
        options.sift.peak_threshold = min_contrast
        path = Path(folder) / "features.db"
        pycolmap.extract_features(
            path,
            picture_folder,
            camera_mode=pycolmap.CameraMode.SINGLE,
            extraction_options=options,
            device=pycolmap.Device.cpu,
        )
        with pycolmap.Database.open(path) as database:
            # Ids follow the order in which threads finished: go by name.
            return [_read(database, picture_folder / name, max_features) for name in names]


def _read(database: pycolmap.Database, path: Path, max_features: int) -> Features:
    picture = database.read_image_with_name(path.name)
    if picture is None or not database.num_keypoints_for_image(picture.image_id):
        return Features(np.zeros((0, 2)), np.zeros((0, 128), np.uint8), np.zeros((0, 3), np.uint8))
    keypoints = database.read_keypoints(picture.image_id).astype(np.float64)
    # COLMAP drops whole levels of scale only, and so leaves up to several times the number asked for.
    size = np.hypot(keypoints[:, 2], keypoints[:, 4])
    kept = np.sort(np.argsort(-size, kind="stable")[:max_features])
    pixels = px_from_colmap(keypoints[kept, :2])
    descriptors = np.array(database.read_descriptors(picture.image_id).data)[kept]
    image = cv2.imread(str(path))[..., ::-1]
    column, row = np.clip(np.rint(pixels).astype(int), 0, np.array(image.shape[1::-1]) - 1).T
    return Features(pixels, descriptors, image[row, column])
