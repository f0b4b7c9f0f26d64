"""Exact, property and rejection: frames, masks and cameras of a made-up sequence, read back."""

from __future__ import annotations

import json

import numpy as np
import pycolmap
import pytest
import trimesh
from PIL import Image

from threedfs.cli.main import main
from threedfs.errors import UserError
from threedfs.geometry.similarity import Similarity
from threedfs.io.frames import Frame, write_frames
from threedfs.io.images import read_image, read_mask
from threedfs.io.meshes import write_mesh
from threedfs.io.points import write_points
from threedfs.io.poses import Poses, write_poses
from threedfs.run_end.export_scene import export_scene
from threedfs.types import Camera, Mesh, SparsePoints, View

CAMERA = Camera(160, 120, 150.0, 150.0, 79.5, 59.5)
DISTORTION = (-0.25, 0.05)
NAMES = ("000000", "IMG 1 (2)")
DISTANCE, RADIUS = 3.0, 0.9


def looking_at_origin(angle):
    """A pose on a circle around the origin."""
    turn = np.array([[np.cos(angle), 0, -np.sin(angle)], [0, 1, 0], [np.sin(angle), 0, np.cos(angle)]])
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = turn, [0.3, 0.2, DISTANCE]
    return pose


def filmed(pose, generator):
    """A photograph of a white ball before grey, noise on both, through the distorted lens; and where the ball is."""
    v, u = np.mgrid[: CAMERA.height, : CAMERA.width]
    seen = np.stack([(u - CAMERA.cx) / CAMERA.fx, (v - CAMERA.cy) / CAMERA.fy], axis=-1)
    ray = seen.copy()
    for _ in range(50):  # the lens model maps the other way
        square = (ray**2).sum(-1, keepdims=True)
        ray = seen / (1 + DISTORTION[0] * square + DISTORTION[1] * square**2)
    direction = np.concatenate([ray, np.ones_like(ray[..., :1])], axis=-1)
    direction /= np.linalg.norm(direction, axis=-1, keepdims=True)
    centre = pose[:3, 3]
    ball = np.linalg.norm(np.cross(direction, centre), axis=-1) < RADIUS
    noise = generator.integers(0, 90, (CAMERA.height, CAMERA.width, 3))
    return np.where(ball[..., None], 255 - noise, 120 - noise).astype(np.uint8)


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """Results of a sequence of two photos of a ball."""
    folder = tmp_path_factory.mktemp("results") / "ball"
    generator = np.random.default_rng(0)
    views = [View(name, CAMERA, looking_at_origin(angle)) for name, angle in zip(NAMES, (0.0, 0.8), strict=True)]
    frames = [Frame(view.name, 0, 0.0, 1.0, filmed(view.cam_from_world, generator)) for view in views]
    write_frames(folder / "01_frames/frames.zarr.zip", frames, {}, ordered=False, source_shape=CAMERA.shape)
    identity = Similarity(1.0, np.eye(3), np.zeros(3))
    write_poses(folder / "02_poses/poses.json", Poses(tuple(views), (), DISTORTION, identity), {})
    points = SparsePoints(
        np.array([[0, 0, 0.5]]), np.array([[1, 2, 3]], np.uint8), np.array([0.25]), np.zeros(2, int), np.arange(2)
    )
    write_points(folder / "02_poses/points.zarr.zip", points, {})
    ball = trimesh.creation.icosphere(subdivisions=4, radius=RADIUS)
    write_mesh(folder / "11_object/surface/mesh.ply", Mesh(ball.vertices, ball.faces))
    return folder


@pytest.fixture(scope="module")
def scene(results, tmp_path_factory):
    """The scene with masks of all kinds."""
    folder = tmp_path_factory.mktemp("scene")
    assert main(["export", str(results), str(folder), "--scene", "--masks", "all"]) == 0
    return folder


FILES = ("000000.png", "IMG_1_2.png")


@pytest.mark.parametrize("file", FILES)
def test_masks_show_the_object_where_their_images_do(scene, file):
    """Property: the lens is taken off both; on the raw frames the share would be 0.9."""
    image, mask = read_image(scene / "images" / file), read_mask(scene / f"masks/{file}.png")
    bright = image.astype(int).mean(axis=-1) > 140
    assert (bright & mask).sum() / (bright | mask).sum() > 0.97


@pytest.mark.parametrize("file", FILES)
def test_all_kinds_of_masks_are_one(scene, file):
    mask = read_mask(scene / f"masks/{file}.png")
    assert 0.1 < mask.mean() < 0.5
    other = np.asarray(Image.open(scene / f"masks_openmvs/{file.removesuffix('.png')}.mask.png"))
    assert other.dtype == np.uint8 and other.ndim == 2
    np.testing.assert_array_equal(other, np.where(mask, 255, 0))
    with Image.open(scene / "images_rgba" / file) as opened:
        assert opened.mode == "RGBA"
        layers = np.asarray(opened)
    np.testing.assert_array_equal(layers[..., 3], np.where(mask, 255, 0))
    np.testing.assert_array_equal(layers[..., :3], read_image(scene / "images" / file))


def test_colmap_finds_the_masks_and_keypoints_on_the_object_alone(scene, tmp_path):
    options = pycolmap.ImageReaderOptions(mask_path=scene / "masks")
    pycolmap.extract_features(tmp_path / "database.db", scene / "images", reader_options=options)
    with pycolmap.Database.open(tmp_path / "database.db") as database:
        for image in database.read_all_images():
            points = database.read_keypoints(image.image_id)
            mask = read_mask(scene / f"masks/{image.name}.png")
            columns, rows = np.floor(points[:, :2]).astype(int).T
            assert len(points) > 20 and mask[rows, columns].all()


def test_colmap_reads_cameras_and_points(scene, results):
    model = pycolmap.Reconstruction(scene / "sparse/0")
    assert sorted(image.name for image in model.images.values()) == sorted(FILES)
    (camera,) = model.cameras.values()
    assert camera.params.tolist() == [150.0, 150.0, 80.0, 60.0]
    (point,) = model.points3D.values()
    assert point.xyz.tolist() == [0, 0, 0.5] and point.color.tolist() == [1, 2, 3] and point.error == 0.25


def test_transforms_name_masks_that_are_there(scene):
    frames = json.loads((scene / "transforms.json").read_text())["frames"]
    assert [frame["file_path"] for frame in frames] == [f"images/{file}" for file in FILES]
    for frame in frames:
        assert (frame["h"], frame["w"]) == read_mask(scene / frame["mask_path"]).shape == CAMERA.shape


def test_only_the_masks_that_were_asked_for_are_written(results, tmp_path):
    export_scene(results, tmp_path, masks=["openmvs"])
    assert {path.name for path in tmp_path.iterdir()} == {"images", "masks_openmvs", "sparse", "transforms.json"}
    assert "mask_path" not in (tmp_path / "transforms.json").read_text()


def test_alpha_is_soft_where_the_mask_is_not_and_goes_into_rgba(results, scene, tmp_path):
    """Property: half of it is the mask; it is written only if asked for by its name."""
    assert main(["export", str(results), str(tmp_path), "--scene", "--masks", "all", "--masks", "alpha"]) == 0
    assert not (scene / "alphas").exists()
    for file in FILES:
        with Image.open(tmp_path / "alphas" / file) as opened:
            assert opened.mode == "L"
            alpha = np.asarray(opened)
        mask = read_mask(scene / f"masks/{file}.png")
        assert 0 < ((alpha > 0) & (alpha < 255)).mean() < 0.2
        assert ((alpha > 127) & mask).sum() / ((alpha > 127) | mask).sum() > 0.97
        with Image.open(tmp_path / "images_rgba" / file) as opened:
            np.testing.assert_array_equal(np.asarray(opened)[..., 3], alpha)
        np.testing.assert_array_equal(read_mask(tmp_path / f"masks/{file}.png"), mask)


def test_a_scene_is_the_same_bytes_again(results, scene, tmp_path):
    export_scene(results, tmp_path, masks=["colmap", "nerfstudio", "openmvs", "rgba"])
    first = {path.relative_to(scene): path.read_bytes() for path in scene.rglob("*") if path.is_file()}
    assert first == {path.relative_to(tmp_path): path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--masks", "rgba"], "expected --scene with --masks"),
        (["--scene", "--height", "95mm"], "expected --scene or --height, got both"),
        (["--scene", "--faces", "500"], "expected --scene or --faces, got both"),
        (["--scene", "--method", "tsdf"], "expected a mesh by the method tsdf, found"),
    ],
)
def test_words_that_do_not_go_together_are_refused(results, tmp_path, capsys, words, sentence):
    assert main(["export", str(results), str(tmp_path / "scene"), *words]) == 1
    assert sentence in capsys.readouterr().err
    assert not (tmp_path / "scene").exists()


def test_a_file_in_the_way_of_a_scene_is_refused(results, tmp_path, capsys):
    (tmp_path / "scene").write_text("mine")
    assert main(["export", str(results), str(tmp_path / "scene"), "--scene"]) == 1
    assert "scene: expected a folder to write a scene into, got a file" in capsys.readouterr().err
    assert (tmp_path / "scene").read_text() == "mine"


def test_frames_that_are_not_there_are_refused(tmp_path):
    with pytest.raises(UserError, match=r"expected cameras of a run, found none"):
        export_scene(tmp_path, tmp_path / "scene")
