"""Round-trip and reproducibility tests of what a film writes."""

import json
from dataclasses import replace

import av
import cv2
import numpy as np
import pytest
from ball import tiny_film, view_from

from threedfs.geometry.projection import project
from threedfs.geometry.rigid import invert
from threedfs.io.given_cameras import read_given_cameras
from threedfs.io.images import read_mask
from threedfs.io.meshes import read_mesh
from threedfs.progress import Progress
from threedfs.synthetic.export import DEPTH_SCALE, FilmFiles, write_film
from threedfs.synthetic.film import shoot_all
from threedfs.synthetic.render import Renderer
from threedfs.synthetic.video import write_video
from threedfs.types import Camera, View

UNSEEN = [view_from((0.5, 0.3, 0.4), camera=tiny_film().camera), view_from((-0.4, 0.2, 0.6), camera=tiny_film().camera)]
UNSEEN = [replace(view, name=f"unseen_{index:02d}") for index, view in enumerate(UNSEEN)]


def contents(folder):
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


def write(folder, processes, log):
    """Write a tiny film and two views that it leaves out."""
    film = tiny_film()
    write_film(
        FilmFiles.below(folder, depth=True),
        film,
        Renderer(film.scene, 4, 4, 0.02),
        unseen=UNSEEN,
        mask_step=2,
        quality=20,
        processes=processes,
        progress=Progress("film", log),
    )


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    folder = tmp_path_factory.mktemp("film")
    with open(folder / "log", "w") as log:
        write(folder / "out", 1, log)
    return folder / "out"


def test_same_seed_same_bytes_on_any_number_of_processes(written, tmp_path):
    with open(tmp_path / "log", "w") as log:
        write(tmp_path / "again", 2, log)
    first, second = contents(written), contents(tmp_path / "again")
    assert sorted(first) == [
        "cameras.json",
        *(f"depth/{frame}.depth.png" for frame in ("000000", "000002")),
        *(f"masks/{name}.png" for name in ("000000", "000002", "unseen_00", "unseen_01")),
        "mesh.ply",
        "video.mp4",
    ]
    assert first == second


def test_frames_give_the_same_video_while_others_are_rendered(tmp_path):
    """The encoder's AVX-512 code gave other bytes once in some thirty runs, only where rendering came in between."""
    film = tiny_film()
    renderer = Renderer(film.scene, 4, 4, 0.02)
    videos = set()
    for _ in range(40):
        write_video(tmp_path / "video.mp4", shoot_all(film, renderer, 1), film.rate, 20)
        videos.add((tmp_path / "video.mp4").read_bytes())
    assert len(videos) == 1


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
    assert [frame.get("video_frame") for frame in content["frames"]] == [0, 1, 2, 3, None, None]
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


def test_depth_images_hold_the_exact_depth_to_their_last_level(written):
    film = tiny_film()
    exact = Renderer(film.scene, 4, 4, 0.02).depth(film.view(2))
    image = cv2.imread(str(written / "depth/000002.depth.png"), cv2.IMREAD_UNCHANGED)
    assert image.dtype == np.uint16 and image.shape == exact.shape
    np.testing.assert_allclose(image / DEPTH_SCALE, exact, atol=0.5 / DEPTH_SCALE + 1e-12)


def test_unseen_views_have_a_camera_and_a_mask_but_no_frame(written):
    film = tiny_film()
    cameras = {camera.name: camera for camera in read_given_cameras(written / "cameras.json")}
    for view in UNSEEN:
        assert cameras[view.name].video_frame is None
        np.testing.assert_allclose(cameras[view.name].cam_from_world, view.cam_from_world, atol=1e-10)
        exact = Renderer(film.scene, 4, 4, 0.02).mask(view)
        assert exact.any() and np.array_equal(read_mask(written / "masks" / f"{view.name}.png"), exact)


def test_frames_can_be_picked():
    film = tiny_film()
    renderer = Renderer(film.scene, 4, 4, 0.02)
    (picked,) = shoot_all(film, renderer, 1, frames=[2])
    assert np.array_equal(picked, film.shoot(renderer, 2))
