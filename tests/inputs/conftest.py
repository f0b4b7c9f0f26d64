"""A folder of sound inputs, to be spoilt one by one."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

sys.path.insert(0, str(Path(__file__).parent))

from specimens import COLUMNS, COUNT, ROWS, cameras, disc, write_mask, write_video


@pytest.fixture(scope="session")
def sound(tmp_path_factory) -> Path:
    """A folder with a video, photos, cameras, masks, a mesh and depth images that belong to each other."""
    folder = tmp_path_factory.mktemp("sound")
    write_video(folder / "video.mp4")
    (folder / "photos").mkdir()
    generator = np.random.default_rng(1)
    for number in range(COUNT):
        image = generator.integers(0, 255, (ROWS, COLUMNS, 3), dtype=np.uint8)
        Image.fromarray(image).save(folder / f"photos/{number:06d}.png")
        write_mask(folder / f"masks/{number:06d}.png", disc())
        (folder / "depth").mkdir(exist_ok=True)
        depth = np.full((ROWS, COLUMNS), 5000, np.uint16)
        Image.fromarray(depth).save(folder / f"depth/{number:06d}.depth.png")
    (folder / "cameras.json").write_text(json.dumps(cameras()))
    trimesh.creation.icosphere(radius=1.1).export(folder / "mesh.ply")
    return folder


@pytest.fixture
def entry(sound) -> dict:
    """A sequence of all that, as the configuration lists it."""
    return {
        "source": str(sound / "video.mp4"),
        "cameras": str(sound / "cameras.json"),
        "calibration": None,
        "truth_masks": str(sound / "masks"),
        "truth_cameras": str(sound / "cameras.json"),
        "truth_mesh": str(sound / "mesh.ply"),
        "truth_depth": str(sound / "depth"),
        "intrinsics": None,
        "depth_scale": 1000.0,
        "depth_camera": None,
    }
