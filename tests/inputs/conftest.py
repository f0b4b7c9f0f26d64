"""A folder of sound inputs, to be spoilt one by one."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from specimens import write_sound


@pytest.fixture(scope="session")
def sound(tmp_path_factory) -> Path:
    """A folder with a video, photos, cameras, masks, a mesh and depth images that belong to each other."""
    return write_sound(tmp_path_factory.mktemp("sound"))


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
