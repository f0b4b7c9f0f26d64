"""HDR video: transfer functions against their standards, and files in 10 bits."""

from __future__ import annotations

import av
import numpy as np
import pytest

from threedfs.frames.hdr import HLG, PQ, compress, decode_pq, tone_map
from threedfs.frames.video import scan_video


def test_pq_is_that_of_the_standard():
    """Exact: 58 % is 203 candela per square metre, 75 % is 1000 (BT.2408, to their two digits)."""
    assert 203 * decode_pq(np.array([0.58, 0.75])) == pytest.approx([203, 1000], rel=0.025)


def test_the_curve_rises_and_stays_below_white():
    light = np.linspace(0, 50, 5001)
    shown = compress(light)
    assert np.all(np.diff(shown) >= 0) and shown[-1] <= 1
    np.testing.assert_array_equal(shown[light <= 0.75], light[light <= 0.75])


def grey(signal):
    """Return a grey frame of a signal in [0, 1], usual range, in 16 bits."""
    yuv = np.empty((4, 6, 3), np.uint16)
    yuv[...] = np.rint(256 * np.array([16 + 219 * signal, 128, 128]))
    return yuv


@pytest.mark.parametrize(
    ("transfer", "signal", "level"),
    [(PQ, 0.0, 0), (PQ, 0.58, 245), (PQ, 0.38, 100), (PQ, 1.0, 255), (HLG, 0.75, 245), (HLG, 0.38, 100)],
)
def test_white_and_middle_grey_are_where_ordinary_video_has_them(transfer, signal, level):
    """Reference: white at 203 candela (58 % PQ, 75 % HLG), a grey card at 26 (38 % of both; BT.2408), sRGB 100."""
    shown = tone_map(grey(signal), transfer)
    assert shown.dtype == np.uint8 and np.ptp(shown) <= 1
    assert abs(int(shown[0, 0, 0]) - level) <= 4


def test_full_range_is_told_apart():
    yuv = np.full((2, 2, 3), 0, np.uint16)
    yuv[..., 0], yuv[..., 1:] = round(0.58 * 65535), 32768
    assert np.abs(tone_map(yuv, PQ, full_range=True).astype(int) - 245).max() <= 3


def test_colours_keep_their_hue_above_white():
    yuv = grey(0.7)
    yuv[..., 2] += 256 * 20
    red, green, blue = tone_map(yuv, PQ)[0, 0].astype(int)
    assert red > green + 40 and red > blue + 20


@pytest.fixture
def make_hdr(drawn):
    """Return a function that writes a video of three frames, 10 bits in BT.2020."""

    def make(path, transfer, codec="libx265", rotation=0):
        with av.open(str(path), "w") as container:
            stream = container.add_stream(codec, rate=30)
            stream.height, stream.width = drawn.shape
            stream.pix_fmt = "yuv420p10le"
            context = stream.codec_context
            context.color_trc, context.color_primaries, context.colorspace, context.color_range = transfer, 9, 9, 1
            silent = {"x265-params": "log-level=none"} if codec == "libx265" else {}
            context.options = {"crf": "6"} | silent
            if rotation:
                stream.set_display_rotation(rotation)
            rows, columns = drawn.shape
            for index in range(3):
                planes = np.full((rows * 3 // 2, columns), 512, np.uint16)
                planes[:rows] = 64 + round(876 * 0.38)  # a grey card, and white on the left
                planes[:rows, : columns // 2] = 64 + round(876 * (0.58 if transfer == PQ else 0.75))
                frame = av.VideoFrame.from_ndarray(planes, format="yuv420p10le")
                frame.pts = index
                container.mux(stream.encode(frame))
            container.mux(stream.encode())
        return path

    return make


@pytest.mark.parametrize("codec", ["libx265", "libx264"])
@pytest.mark.parametrize("transfer", [PQ, HLG])
def test_a_phones_hdr_video_gets_ordinary_levels(tmp_path, make_hdr, drawn, transfer, codec):
    video = scan_video(make_hdr(tmp_path / "hdr.mp4", transfer, codec))
    images = [picture.load() for picture in video.pictures()]
    assert len(images) == 3
    for image in images:
        assert image.shape == (*drawn.shape, 3) and image.dtype == np.uint8
        assert np.abs(image[8:-8, 8:60].astype(int) - 245).max() <= 5
        assert np.abs(image[8:-8, 100:-8].astype(int) - 100).max() <= 5


def test_hdr_video_is_turned_upright_too(tmp_path, make_hdr, drawn):
    video = scan_video(make_hdr(tmp_path / "hdr.mp4", HLG, rotation=-90))
    image = next(iter(video.pictures())).load()
    assert image.shape[:2] == video.shape == drawn.shape[::-1]
    assert image[20, 48].mean() > 200 > image[-20, 48].mean()  # what was left is above


def test_ordinary_video_is_decoded_as_ever(tmp_path, make_video):
    """Exact: the same bytes as FFmpeg's own conversion, also where 10 bits are not HDR."""
    path = make_video(tmp_path / "video.mp4", count=3)
    with av.open(str(path)) as container:
        own = [frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)]
    for picture, expected in zip(scan_video(path).pictures(), own, strict=True):
        np.testing.assert_array_equal(picture.load(), expected)
