"""Exact and round-trip tests of the encoder's input and output."""

import av
import numpy as np
import pytest

from threedfs.synthetic.video import to_yuv420, write_video


@pytest.mark.parametrize(
    ("colour", "yuv"),
    [
        ((0, 0, 0), (16, 128, 128)),
        ((255, 255, 255), (235, 128, 128)),
        ((255, 0, 0), (81, 90, 240)),
        ((0, 255, 0), (145, 54, 34)),
        ((0, 0, 255), (41, 240, 110)),
    ],
)
def test_colours_of_bt601(colour, yuv):
    planes = to_yuv420(np.tile(np.array(colour, np.uint8), (4, 8, 1)))
    assert planes.shape == (6, 8)
    assert (planes[:4] == yuv[0]).all() and (planes[4] == yuv[1]).all() and (planes[5] == yuv[2]).all()


def test_a_smooth_video_survives(tmp_path):
    v, u = np.mgrid[:48, :64]
    frames = [np.stack([40 + 2 * u, 60 + 3 * v, 150 - u + k], axis=-1).astype(np.uint8) for k in range(5)]
    write_video(tmp_path / "video.mp4", frames, rate=24, quality=10)
    with av.open(str(tmp_path / "video.mp4")) as container:
        stream = container.streams.video[0]
        assert (stream.width, stream.height, stream.average_rate) == (64, 48, 24)
        decoded = [(frame.time, frame.to_ndarray(format="rgb24", threads=1)) for frame in container.decode(video=0)]
    assert [time for time, _ in decoded] == pytest.approx([k / 24 for k in range(5)])
    for (_, image), truth in zip(decoded, frames, strict=True):
        # Chroma is halved and rounded, and red and blue are rebuilt from it: a few levels.
        assert np.abs(image.astype(int) - truth).mean() < 3
