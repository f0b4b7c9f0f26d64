"""`threedfs check`: good films pass, bad ones are refused for what is wrong with them."""

from __future__ import annotations

from fractions import Fraction

import av
import cv2
import numpy as np
import pytest

from threedfs.cli.main import main
from threedfs.footage.motion import Step, sweep_angle
from threedfs.footage.verdict import BAD, GOOD, conclude, judge_film
from threedfs.geometry.rigid import look_at

ROWS, COLUMNS, FOCAL = 240, 320, 270.0
FRAMES = 24


def make_texture(seed, detail=(20, 70, 200)):
    rng = np.random.default_rng(seed)
    layers = [
        cv2.resize(rng.uniform(0, 1, (n, n)).astype(np.float32), (600, 600), interpolation=cv2.INTER_CUBIC)
        for n in detail
    ]
    return np.clip(255 * sum(layers) / len(detail), 0, 255)


FLOOR, SHEET = make_texture(1), make_texture(2)


def photograph(pose):
    """Return the picture (240, 320, 3) of two textured levels, a floor and a small shelf above it."""
    v, u = np.mgrid[:ROWS, :COLUMNS]
    rays = np.stack([(u - COLUMNS / 2) / FOCAL, (v - ROWS / 2) / FOCAL, np.ones(u.shape)], axis=-1) @ pose[:3, :3]
    centre = -pose[:3, :3].T @ pose[:3, 3]

    def meet(height, texture, size):
        ground = centre[:2] + (height - centre[2]) / rays[..., 2:] * rays[..., :2]
        places = (300 + ground * 300 / size).astype(np.float32)
        seen = cv2.remap(texture, places[..., 0], places[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REFLECT)
        return seen, np.abs(ground).max(axis=-1) < size

    floor, shelf = meet(0.0, FLOOR, 2.0), meet(0.4, SHEET, 0.4)
    grey = np.where(shelf[1], shelf[0], floor[0])
    return np.repeat(np.clip(np.rint(grey), 0, 255).astype(np.uint8)[..., None], 3, axis=2)


def walk(turn=1.0, still=False, pan=False):
    """Return poses of a walk around the origin, of standing still, or of panning on the spot."""
    poses = []
    for share in np.arange(FRAMES) / FRAMES:
        angle = 2 * np.pi * turn * share
        if still:
            angle = 0.0
        centre = np.array([1.6 * np.cos(angle), 1.6 * np.sin(angle), 1.3])
        target = np.zeros(3)
        if pan:
            centre, target = np.array([1.6, 0.0, 1.3]), np.array([0.0, 1.2 * (share - 0.5), 0.0])
        poses.append(look_at(centre, target, np.array([0.0, 0.0, 1.0])))
    return poses


@pytest.fixture(scope="module")
def around():
    """The pictures of a good film."""
    return [photograph(pose) for pose in walk()]


def write(path, images, rotation=0):
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264", rate=Fraction(4))
        stream.height, stream.width = images[0].shape[:2]
        stream.pix_fmt, stream.options = "yuv420p", {"crf": "16"}
        if rotation:
            stream.set_display_rotation(rotation)
        for image in images:
            container.mux(stream.encode(av.VideoFrame.from_ndarray(np.ascontiguousarray(image), format="rgb24")))
        container.mux(stream.encode())
    return str(path)


def test_a_good_film_passes(tmp_path, around, capsys):
    assert main(["check", write(tmp_path / "good.mp4", around)]) == 0
    said = capsys.readouterr().out
    assert "320x240 pixels, H.264, 4 frames a second" in said and "It can be used" in said and "  bad" not in said


@pytest.mark.parametrize(
    ("spoil", "wrong"),
    [
        (lambda image: cv2.GaussianBlur(image, (0, 0), 6), "sharpness"),
        (lambda image: (image * 0.06).astype(np.uint8), "light"),
        (lambda image: np.clip(image.astype(int) * 6, 0, 255).astype(np.uint8), "light"),
        (lambda image: np.full_like(image, 128), "texture"),
    ],
)
def test_bad_pictures_are_told(tmp_path, around, capsys, spoil, wrong):
    assert main(["check", write(tmp_path / "bad.mp4", [spoil(image) for image in around])]) == 1
    verdict = capsys.readouterr().out.splitlines()[-1]
    assert verdict.startswith("verdict: It cannot be used") and wrong in verdict


@pytest.mark.parametrize(("way", "wrong"), [({"still": True}, "motion"), ({"pan": True}, "parallax")])
def test_a_camera_that_stays_where_it_is_is_told(tmp_path, capsys, way, wrong):
    noise = np.random.default_rng(0)
    images = [photograph(pose) + noise.integers(0, 4, (ROWS, COLUMNS, 1), np.uint8) for pose in walk(**way)]
    assert main(["check", write(tmp_path / "stays.mp4", images)]) == 1
    assert wrong in capsys.readouterr().out.splitlines()[-1]


def test_a_short_film_is_told_and_a_turned_one_is_no_fault(tmp_path, around, capsys):
    assert main(["check", write(tmp_path / "short.mp4", around[:5], rotation=-90)]) == 1
    said = capsys.readouterr().out
    assert "240x320" in said and "turned upright as its rotation flag says" in said
    assert "It cannot be used as it is: length" in said


def test_a_folder_of_photos_is_checked_too(tmp_path, around, capsys):
    for index, image in enumerate(around):
        cv2.imwrite(str(tmp_path / f"{index:02d}.png"), image)
    assert main(["check", str(tmp_path)]) == 0
    assert f"{FRAMES} photos" in capsys.readouterr().out


def test_photos_that_cannot_be_read_count_once(tmp_path, around, capsys):
    for index, image in enumerate(around[:9]):
        cv2.imwrite(str(tmp_path / f"{index:02d}.png"), image)
    for index in range(3):
        (tmp_path / f"broken{index}.png").write_bytes(b"no picture")
    main(["check", str(tmp_path)])
    said = capsys.readouterr().out
    assert "12 photos" in said and "3 of 12 cannot be decoded" in said and "photos: 9" in said


def test_photos_that_show_too_little_in_common_are_not_to_be_filmed_slower():
    opinions = judge_film([], [Step(0, 0.0, 0.0, None)] * 9, seconds=None, frames=30)
    (advice,) = [opinion.advice for opinion in opinions if opinion.what == "connection"]
    assert "take more of them" in advice and "film" not in advice


def test_what_is_no_film_is_refused_in_a_sentence(tmp_path, capsys):
    (tmp_path / "x.mp4").write_text("no film")
    assert main(["check", str(tmp_path / "x.mp4")]) == 1
    assert main(["check", str(tmp_path / "none.mp4")]) == 1
    (tmp_path / "empty").mkdir()
    assert main(["check", str(tmp_path / "empty")]) == 1
    told = capsys.readouterr().err
    assert told.count("threedfs: ") == 3 and "got a folder without such files" in told


def test_the_way_around_is_that_of_the_turns():
    """Exact: ten turns of 12 degrees about the camera's own vertical."""
    turn = cv2.Rodrigues(np.array([0.0, np.radians(12), 0.0]))[0]
    assert sweep_angle([turn] * 10) == pytest.approx(120)
    assert sweep_angle([turn, None, turn]) == pytest.approx(24)


def test_nothing_looked_at_is_no_good_verdict():
    opinions = judge_film([], [], seconds=0.0, frames=0)
    assert [opinion.grade for opinion in opinions] == [BAD] and GOOD not in conclude(opinions)
