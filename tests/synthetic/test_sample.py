"""Regression tests: the shipped sample is what its code makes, and is what it claims to be."""

import json
from pathlib import Path

import av
import numpy as np
import pytest

from threedfs.io.images import read_mask
from threedfs.io.meshes import read_mesh
from threedfs.synthetic.export import write_cameras
from threedfs.synthetic.render import Renderer
from threedfs.synthetic.sample import MASK_STEP, sample_film

SAMPLE = Path(__file__).parents[2] / "resources" / "sample"


@pytest.fixture(scope="module")
def film():
    return sample_film()


def test_the_sample_is_complete_and_small():
    files = [p for p in SAMPLE.rglob("*") if p.is_file()]
    assert sum(p.stat().st_size for p in files) < 6e6
    masks = sorted(p.name for p in (SAMPLE / "masks").iterdir())
    assert masks == [f"{frame:06d}.png" for frame in range(0, 240, MASK_STEP)]
    with av.open(str(SAMPLE / "video.mp4")) as container:
        stream = container.streams.video[0]
        assert (stream.width, stream.height, stream.frames, stream.average_rate) == (640, 480, 240, 30)
        assert stream.codec_context.name == "h264"


def test_cameras_and_mesh_are_those_of_the_code(film, tmp_path):
    write_cameras(tmp_path / "cameras.json", film)
    shipped, made = (json.loads((folder / "cameras.json").read_text()) for folder in (SAMPLE, tmp_path))
    assert len(shipped["frames"]) == 240
    for one, other in zip(shipped["frames"], made["frames"], strict=True):
        np.testing.assert_allclose(one["cam_to_world"], other["cam_to_world"], atol=1e-11)  # written with 12 digits
    mesh = read_mesh(SAMPLE / "mesh.ply")
    assert np.array_equal(mesh.faces, film.scene.solid.mesh.faces)
    np.testing.assert_allclose(mesh.vertices, film.scene.solid.mesh.vertices, atol=1e-7)  # single precision


def test_frames_and_masks_are_those_of_the_code(film):
    frame = 130
    renderer = Renderer(film.scene)
    assert np.array_equal(read_mask(SAMPLE / "masks" / f"{frame:06d}.png"), renderer.mask(film.view(frame)))
    with av.open(str(SAMPLE / "video.mp4")) as container:
        for index, decoded in enumerate(container.decode(video=0)):
            if index == frame:
                image = decoded.to_ndarray(format="rgb24", threads=1).astype(float)
                break
    error = image - film.shoot(renderer, frame)
    # Compression at constant rate factor 19 leaves about 38 dB; the next frame, 1.5 degrees on, differs by 22 dB.
    assert 10 * np.log10(255**2 / (error**2).mean()) > 32


def test_the_film_goes_around_the_object_and_keeps_it_in_sight(film):
    centres = np.array([film.view(frame).centre for frame in range(film.frames)])
    azimuth = np.unwrap(np.arctan2(centres[:, 1], centres[:, 0]))
    assert np.degrees(azimuth[-1] - azimuth[0]) == pytest.approx(360, abs=20)
    step = np.linalg.norm(np.diff(centres[::10], axis=0), axis=1)
    assert step.max() / np.median(step) < 3  # the gate on the continuity of a path
    for frame in range(0, film.frames, MASK_STEP):
        mask = read_mask(SAMPLE / "masks" / f"{frame:06d}.png")
        rows, columns = np.nonzero(mask)
        assert rows.min() > 20 and rows.max() < 460 and columns.min() > 20 and columns.max() < 620
        assert 0.25 < np.ptp(rows) / 480 < 0.5
