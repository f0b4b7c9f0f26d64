"""The stage on a keyframe, by either method."""

from __future__ import annotations

import numpy as np
import pytest

from threedfs.edges.multiscale import multiscale_gradient
from threedfs.edges.structured import structured_contours
from threedfs.io.contour_forest import SHA256, read_forest
from threedfs.io.crops import Crop, write_crops
from threedfs.io.depth_maps import read_edges
from threedfs.io.keyframes import write_keyframes
from threedfs.job import Job
from threedfs.params.edges import EdgesParams
from threedfs.progress import Progress
from threedfs.stages import edges as stage
from threedfs.store import code
from threedfs.types import Camera, Keyframe, View


@pytest.fixture(scope="module")
def image():
    image = np.full((48, 64, 3), 70, np.uint8)
    image[12:36, 20:44] = (170, 120, 60)
    return image


@pytest.fixture
def strength_by(image, tmp_path):
    """What the stage writes of a keyframe, by parameters."""
    view = View("key", Camera(64, 48, 60.0, 60.0, 31.5, 23.5), np.eye(4))
    crop = Crop("key", image, np.ones(image.shape[:2], bool))
    write_crops(tmp_path / "c.zip", [crop], {}, ordered=False, source_shape=image.shape[:2])
    write_keyframes(tmp_path / "k.json", [Keyframe(view, (), 0.5, 2.0)], {})

    def strength(**params):
        stage.run(
            crops=tmp_path / "c.zip",
            keyframes=tmp_path / "k.json",
            edges=tmp_path / "e.zip",
            keyframe="key",
            params=EdgesParams(**params),
            job=Job(Progress("edges")),
        )
        return read_edges(tmp_path / "e.zip")

    return strength


def test_the_method_decides(strength_by, image):
    """Exact: the stage writes what either detector gives, and gradients without being asked."""
    everywhere = np.ones(image.shape[:2], bool)
    gradient = multiscale_gradient(image, everywhere, (1.0, 2.0, 4.0), 98.0, 2.0)
    np.testing.assert_array_equal(strength_by(), gradient)
    np.testing.assert_array_equal(
        strength_by(method="structured"), structured_contours(image, everywhere, read_forest())
    )


def test_another_forest_is_another_code(monkeypatch):
    """Exact: the identity of the stage's code covers the module in whose source the checksum stands."""
    read = set()
    read_module = code._read_module
    monkeypatch.setattr(code, "_read_module", lambda path, *rest: read.add(path) or read_module(path, *rest))
    code.digest_code("threedfs.stages.edges")
    source = code.find_source("threedfs.io.contour_forest")
    assert source in read
    assert f'SHA256 = "{SHA256}"' in source.read_text()
