"""Round-trip and reproducibility tests of what a film writes."""

import json

import av
import numpy as np
import pytest
from ball import tiny_film

from threedfs.geometry.projection import project
from threedfs.geometry.rigid import invert
from threedfs.io.images import read_mask
from threedfs.io.meshes import read_mesh
from threedfs.progress import Progress
from threedfs.synthetic.export import write_film
from threedfs.synthetic.film import shoot_all
from threedfs.synthetic.render import Renderer
from threedfs.types import Camera, View


def contents(folder):
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    folder = tmp_path_factory.mktemp("film")
    with open(folder / "log", "w") as log:
        write_film(folder / "out", tiny_film(), 2, 20, 1, Progress("film", log))
    return folder / "out"


def test_same_seed_same_bytes_on_any_number_of_processes(written, tmp_path):
    with open(tmp_path / "log", "w") as log:
        write_film(tmp_path / "again", tiny_film(), 2, 20, 2, Progress("film", log))
    first, second = contents(written), contents(tmp_path / "again")
    assert sorted(first) == ["cameras.json", "masks/000000.png", "masks/000002.png", "mesh.ply", "video.mp4"]
    assert first == second


def test_video_holds_the_frames(written):
    film = tiny_film()
    with av.open(str(written / "video.mp4")) as container:
        assert container.streams.video[0].average_rate == film.rate
        decoded = [frame.to_ndarray(format="rgb24", threads=1) for frame in container.decode(video=0)]
    assert len(decoded) == film.frames
    for image, truth in zip(decoded, shoot_all(film, Renderer(film.scene), 1), strict=True):
        error = image.astype(float).mean(axis=2) - truth.mean(axis=2)
        assert np.sqrt((error**2).mean()) < 6  # quality 20 on noisy 64x48 images; another frame differs by 20


def test_cameras_are_in_the_convention_of_colmap(written):
    """Read back as a stranger would, the cameras project the mesh onto the masks."""
    content = json.loads((written / "cameras.json").read_text())
    camera = Camera(
        content["width"], content["height"], content["fx"], content["fy"], content["cx"] - 0.5, content["cy"] - 0.5
    )
    assert (content["cx"], content["cy"], content["k1"]) == (32.0, 24.0, 0.0)
    assert [frame["video_frame"] for frame in content["frames"]] == [0, 1, 2, 3]
    mesh = read_mesh(written / "mesh.ply")
    for frame in content["frames"][::2]:
        view = View(frame["name"], camera, invert(np.array(frame["cam_to_world"])))
        pixels, depth = project(view, mesh.vertices)
        mask = read_mask(written / "masks" / f"{frame['name']}.png")
        v, u = np.nonzero(mask)
        assert np.all(depth > 0)
        # Pixel centres inside the outline lie up to about a pixel inside its box.
        np.testing.assert_array_less(pixels.min(axis=0) - 1e-9, (u.min(), v.min()))
        np.testing.assert_array_less((u.max(), v.max()), pixels.max(axis=0) + 1e-9)
        assert np.all(pixels.max(axis=0) - (u.max(), v.max()) < 1.3)
        assert np.all((u.min(), v.min()) - pixels.min(axis=0) < 1.3)


def test_frames_can_be_picked():
    film = tiny_film()
    renderer = Renderer(film.scene, 4, 4, 0.02)
    (picked,) = shoot_all(film, renderer, 1, frames=[2])
    assert np.array_equal(picked, film.shoot(renderer, 2))
