"""Exact: which frames of a video are given, which way up, with which number and time; damage is passed over."""

import numpy as np
import pytest

from threedfs.errors import UserError
from threedfs.frames.video import orient, scan_video


@pytest.mark.parametrize("codec", ["libx264", "libx265"])
@pytest.mark.parametrize("suffix", ["mp4", "mov"])
def test_every_frame_of_every_codec(tmp_path, make_video, drawn, codec, suffix):
    video = scan_video(make_video(tmp_path / f"video.{suffix}", count=12, codec=codec))
    pictures = list(video.pictures())
    assert video.shape == drawn.shape
    assert [p.name for p in pictures] == [f"{i:06d}" for i in range(12)]
    assert [p.time for p in pictures] == pytest.approx(np.arange(12) / 30)


def test_pixels_are_those_drawn(tmp_path, make_video, drawn):
    video = scan_video(make_video(tmp_path / "video.mp4", count=12))
    for picture in video.pictures():
        assert drawn.number(picture.load()) == pytest.approx(picture.index, abs=1)  # colour is coded to +-2 levels


@pytest.mark.parametrize(
    ("rotation", "mirrored", "corners"),
    [
        (0, False, {"red": "upper left", "green": "lower right"}),
        (90, False, {"red": "lower left", "green": "upper right"}),
        (-90, False, {"red": "upper right", "green": "lower left"}),
        (180, False, {"red": "lower right", "green": "upper left"}),
        (0, True, {"red": "upper right", "green": "lower left"}),
        (90, True, {"red": "lower right", "green": "upper left"}),
    ],
)
def test_rotation_is_applied(tmp_path, make_video, drawn, rotation, mirrored, corners):
    video = scan_video(make_video(tmp_path / "video.mp4", count=2, rotation=rotation, mirrored=mirrored))
    image = next(video.pictures()).load()
    assert image.shape[:2] == video.shape == (drawn.shape[::-1] if abs(rotation) == 90 else drawn.shape)
    assert drawn.corners(image) == corners


def test_variable_frame_rate_keeps_numbers_and_times(tmp_path, make_video):
    times = [0, 0.02, 0.5, 0.55, 2.0, 2.01, 2.4]
    pictures = list(scan_video(make_video(tmp_path / "video.mp4", count=7, times=times)).pictures())
    assert [p.index for p in pictures] == list(range(7))
    assert [p.time for p in pictures] == pytest.approx(times, abs=1 / 600)  # the container's tick


@pytest.mark.parametrize("damage", ["end", "middle", "truncated"])
def test_damage_is_passed_over_and_numbers_hold(tmp_path, make_video, drawn, damage):
    path = make_video(tmp_path / "video.mp4", count=40)
    data = bytearray(path.read_bytes())
    half = len(data) // 2
    if damage == "end":
        data[-200:] = bytes(200)
    elif damage == "middle":
        data[half : half + 600] = bytes(600)
    else:
        del data[half:]
    path.write_bytes(data)
    video = scan_video(path)
    numbers = {p.index: drawn.number(p.load()) for p in video.pictures()}
    right = [index for index, number in numbers.items() if abs(number - index) < 1]
    assert len(numbers) < 40
    assert len(right) >= 15
    # A few frames after the damage may be patched up by the decoder; the rest must carry their own number.
    assert len(right) >= len(numbers) - 5


@pytest.mark.parametrize(
    ("content", "said"),
    [(b"", "empty file"), (b"no video at all\n" * 50, "video"), (bytes(range(256)) * 20, "cannot be opened")],
)
def test_what_is_no_video_is_refused(tmp_path, content, said):
    path = tmp_path / "film.mp4"
    path.write_bytes(content)
    with pytest.raises(UserError, match=said) as refusal:
        scan_video(path)
    assert str(path) in str(refusal.value)


def test_text_is_refused(tmp_path):
    path = tmp_path / "notes.txt"
    path.write_text("this is no video\n" * 50)
    with pytest.raises(UserError, match="without a video stream"):
        scan_video(path)


def test_video_without_frames_is_refused(tmp_path, make_video):
    with pytest.raises(UserError, match="expected a video"):
        scan_video(make_video(tmp_path / "film.mp4", count=0))


def test_orient_takes_any_scale_of_matrix():
    image = np.arange(12).reshape(2, 2, 3)
    quarter = np.array([[0, -65536], [65536, 0]])
    np.testing.assert_array_equal(orient(image, quarter), np.rot90(image))
