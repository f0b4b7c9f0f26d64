"""Exact and rejection: from source to frames.zarr.zip, and what bad sources say."""

import tracemalloc

import numpy as np
import pytest
from PIL import Image

from threedfs.errors import UserError
from threedfs.io.frames import read_frames
from threedfs.params.frames import FramesParams
from threedfs.stages import frames as stage


@pytest.fixture
def decode(tmp_path, job):
    def run(source, masks=None, **settings):
        path = tmp_path / "results" / "frames.zarr.zip"
        stage.run(source=source, masks=masks, frames=path, params=FramesParams(**settings), job=job)
        return read_frames(path)

    return run


def write_masks(folder, names, shape):
    folder.mkdir()
    for name in names:
        mask = np.zeros(shape, np.uint8)
        mask[20:40, 30:60] = 255
        Image.fromarray(mask).save(folder / f"{name}.png")
    return folder


def test_uniform_step_and_working_size(tmp_path, decode, make_video, drawn):
    store = decode(make_video(tmp_path / "v.mp4", count=33), max_frames=10, longest_side=80)
    assert store.names == tuple(f"{i:06d}" for i in range(0, 33, 4))
    assert (store.shape, store.source_shape, store.ordered) == ((48, 80), (96, 160), True)
    assert store.indices.tolist() == list(range(0, 33, 4))
    np.testing.assert_allclose(store.times, np.arange(0, 33, 4) / 30, atol=1e-9)
    assert store.skipped == 0
    for name in store.names:
        assert drawn.number(store.image(name)) == pytest.approx(int(name), abs=1)


def test_frames_with_masks_are_kept_as_well(tmp_path, decode, make_video):
    masks = write_masks(tmp_path / "masks", ["3", "000004", "0017", "999"], (96, 160))
    store = decode(make_video(tmp_path / "v.mp4", count=33), masks, max_frames=10)
    assert store.names == tuple(f"{i:06d}" for i in sorted({*range(0, 33, 4), 3, 17}))


def test_photos_keep_their_names_and_masks_match_by_stem(tmp_path, decode, drawn):
    photos = tmp_path / "photos"
    photos.mkdir()
    for index in range(20):
        Image.fromarray(drawn.draw(index)).save(photos / f"IMG_{index:02d}.png")
    masks = write_masks(tmp_path / "masks", ["IMG_07", "other"], (96, 160))
    store = decode(photos, masks, max_frames=10)
    assert store.names == tuple(f"IMG_{i:02d}" for i in sorted({*range(0, 20, 2), 7}))
    assert not store.ordered
    np.testing.assert_array_equal(store.image("IMG_07"), drawn.draw(7))  # small enough: not scaled


def test_a_photo_that_breaks_off_is_skipped_and_told(tmp_path, decode, drawn, log):
    for index in range(10):
        Image.fromarray(drawn.draw(index)).save(tmp_path / f"{index}.jpg")
    data = (tmp_path / "4.jpg").read_bytes()
    (tmp_path / "4.jpg").write_bytes(data[: len(data) // 2])
    store = decode(tmp_path)
    assert "4" not in store.names and len(store.names) == 9
    assert store.skipped == 1
    assert "4: left out, it cannot be decoded" in log.getvalue()


def test_bad_frames_at_the_end_are_counted(tmp_path, decode, make_video):
    path = make_video(tmp_path / "v.mp4", count=40)
    data = bytearray(path.read_bytes())
    data[-200:] = bytes(200)
    path.write_bytes(data)
    store = decode(path)
    assert 1 <= store.skipped <= 10  # the last group of five, and the one that shares its bytes
    assert len(store.names) == 40 - store.skipped


def test_the_next_good_frame_stands_in_for_a_blank_one(tmp_path, decode, make_video, drawn, log):
    def draw(index):
        return drawn.draw(index) if index not in (8, 9) else np.full((96, 160, 3), 90, np.uint8)

    store = decode(make_video(tmp_path / "v.mp4", count=33, draw=draw), max_frames=10)
    assert store.names == tuple(f"{i:06d}" for i in (0, 4, 10, 12, 16, 20, 24, 28, 32))
    assert "2 blank" in log.getvalue()


def test_two_runs_give_the_same_bytes(tmp_path, decode, make_video):
    source = make_video(tmp_path / "v.mp4")
    decode(source)
    first = (tmp_path / "results" / "frames.zarr.zip").read_bytes()
    decode(source)
    assert (tmp_path / "results" / "frames.zarr.zip").read_bytes() == first


def test_memory_does_not_grow_with_the_video(tmp_path, decode, make_video):
    def peak(count):
        source = make_video(tmp_path / f"{count}.mp4", count=count)
        tracemalloc.start()
        decode(source)
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        return peak

    peak(10)  # imports and caches
    # 60 more frames of 46 kB would be 2.8 MB; lists of names, times and zip entries take the rest.
    assert peak(80) - peak(20) < 0.5e6


def blank_video(path, make_video):
    return make_video(path, draw=lambda index: np.full((96, 160, 3), 90, np.uint8))


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda path, make_video: path, "found no such file"),
        (lambda path, make_video: make_video(path, count=7), "at least 8 usable frames, got 7 of 7"),
        (blank_video, r"at least 8 usable frames, got 0 of 20 \(20 blank, 0 that"),
    ],
    ids=["missing", "short", "blank"],
)
def test_unusable_sources_are_refused_and_nothing_is_left(tmp_path, decode, make_video, make, said):
    path = tmp_path / "v.mp4"
    with pytest.raises(UserError, match=said) as refusal:
        decode(make(path, make_video))
    assert str(refusal.value).startswith(str(path))
    assert not list(tmp_path.glob("results/*"))


def test_masks_of_the_wrong_size_are_refused(tmp_path, decode, make_video):
    masks = write_masks(tmp_path / "masks", ["4"], (48, 80))
    with pytest.raises(UserError, match=r"4\.png: expected a mask .* 160x96 pixels, got 80x48"):
        decode(make_video(tmp_path / "v.mp4"), masks)


def test_masks_of_no_frame_are_refused(tmp_path, decode, make_video):
    masks = write_masks(tmp_path / "masks", ["100", "first"], (96, 160))
    with pytest.raises(UserError, match="got 2 png files none of which belongs to a frame"):
        decode(make_video(tmp_path / "v.mp4"), masks)


def test_a_missing_mask_folder_is_refused(tmp_path, decode, make_video):
    with pytest.raises(UserError, match="expected a folder of masks"):
        decode(make_video(tmp_path / "v.mp4"), tmp_path / "nowhere")
