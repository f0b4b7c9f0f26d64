"""COLMAP model folders."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pycolmap

from threedfs.colmap.lens import read_colmap_camera
from threedfs.geometry.lens import Lens


def read_posed_images(folder: Path) -> list[tuple[str, Lens, np.ndarray]]:
    """Read the images of a COLMAP model, text or binary, in the order of their names.

    Returns
    -------
    list of (str, Lens, (4, 4) float64)
        Name, intrinsics with integer pixel centres, cam_from_world.

    Raises
    ------
    ValueError
        If the folder holds no whole model or a camera has other than radial distortion.
    """
    try:
        model = pycolmap.Reconstruction(folder)
    except Exception as fault:
        raise ValueError(f"files that COLMAP cannot read ({str(fault).splitlines()[0]})") from fault
    found = []
    for identity in model.reg_image_ids():
        image = model.image(identity)
        pose = np.eye(4)
        pose[:3] = image.cam_from_world().matrix()
        found.append((image.name, read_colmap_camera(model.camera(image.camera_id)), pose))
    return sorted(found, key=lambda entry: entry[0])
