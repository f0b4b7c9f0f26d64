"""Exact: which photos of a folder are given, upright; damaged and odd ones are left out and told."""

import sys

import numpy as np
import pytest
from PIL import Image

from threedfs.errors import UserError
from threedfs.frames.photos import scan_photos
from threedfs.progress import Progress


@pytest.fixture
def progress(log):
    return Progress("test", log)


def save(path, image, **options):
    Image.fromarray(image).save(path, **options)


@pytest.mark.parametrize("suffix", ["jpg", "png", "webp", "tif", "bmp", "JPG"])
def test_photo_formats(tmp_path, drawn, progress, suffix):
    save(tmp_path / f"a.{suffix}", drawn.draw(0))
    photos = scan_photos(tmp_path, progress)
    (picture,) = photos.pictures()
    assert (picture.name, picture.index, photos.shape) == ("a", 0, drawn.shape)
    assert drawn.corners(picture.load()) == {"red": "upper left", "green": "lower right"}


def test_sorted_by_name_and_untimed(tmp_path, drawn, progress):
    for name in ("c", "a", "b"):
        save(tmp_path / f"{name}.png", drawn.draw(0))
    pictures = list(scan_photos(tmp_path, progress).pictures())
    assert [(p.name, p.index) for p in pictures] == [("a", 0), ("b", 1), ("c", 2)]
    assert all(np.isnan(p.time) for p in pictures)


@pytest.mark.parametrize("orientation", range(1, 9))
def test_exif_orientation(tmp_path, drawn, progress, orientation):
    upright = drawn.draw(0)
    # What the sensor stored, so that the orientation brings it upright: the inverse of what the standard says.
    stored = {
        1: upright,
        2: upright[:, ::-1],
        3: upright[::-1, ::-1],
        4: upright[::-1],
        5: upright.swapaxes(0, 1),
        6: np.rot90(upright),
        7: np.rot90(upright, 2).swapaxes(0, 1),
        8: np.rot90(upright, -1),
    }[orientation]
    exif = Image.Exif()
    exif[274] = orientation
    save(tmp_path / "a.png", np.ascontiguousarray(stored), exif=exif)
    photos = scan_photos(tmp_path, progress)
    assert photos.shape == drawn.shape
    np.testing.assert_array_equal(next(photos.pictures()).load(), upright)


def test_corrupt_and_odd_files_are_left_out_and_told(tmp_path, drawn, progress, log):
    for name in "abc":
        save(tmp_path / f"{name}.png", drawn.draw(0))
    save(tmp_path / "small.png", drawn.draw(0)[:50])
    (tmp_path / "torn.jpg").write_bytes(b"\xff\xd8\xff\xe0 no photo")
    (tmp_path / "notes.txt").write_text("not looked at")
    (tmp_path / "._a.png").write_bytes(b"not looked at either")
    Image.fromarray(np.full(drawn.shape, 1500, np.uint16)).save(tmp_path / "a.depth.png")
    photos = scan_photos(tmp_path, progress)
    assert photos.names == ("a", "b", "c")
    assert photos.unreadable == 1
    told = log.getvalue()
    assert "torn.jpg: left out, it cannot be read" in told
    assert "small.png: left out, 160x50 pixels, while most photos are 160x96" in told
    assert "1 files left out, 16-bit" in told
    assert "notes" not in told and "._a" not in told


def test_a_photo_that_breaks_off_loads_as_none(tmp_path, drawn, progress):
    save(tmp_path / "a.jpg", drawn.draw(0))
    data = (tmp_path / "a.jpg").read_bytes()
    (tmp_path / "a.jpg").write_bytes(data[: len(data) // 2])
    assert next(scan_photos(tmp_path, progress).pictures()).load() is None


def test_two_photos_of_one_name_are_refused(tmp_path, drawn, progress):
    save(tmp_path / "a.png", drawn.draw(0))
    save(tmp_path / "a.jpg", drawn.draw(0))
    with pytest.raises(UserError, match="several named 'a'"):
        scan_photos(tmp_path, progress)


def test_a_folder_without_photos_is_refused(tmp_path, progress):
    with pytest.raises(UserError, match=r"got a folder without such files\.$"):
        scan_photos(tmp_path, progress)


@pytest.mark.parametrize("orientation", [1, 3, 6, 8])
def test_photos_of_phones_are_read_upright(tmp_path, drawn, progress, orientation):
    """To compression: HEIC turns its pictures by itself, and they must not be turned twice."""
    heif = pytest.importorskip("pillow_heif", reason="pillow-heif is not installed here")
    heif.register_heif_opener()
    turns = {1: 0, 3: 2, 6: 1, 8: -1}[orientation]
    exif = Image.Exif()
    exif[274] = orientation
    stored = np.ascontiguousarray(np.rot90(drawn.draw(0), turns))
    Image.fromarray(stored).save(tmp_path / "IMG_1.HEIC", quality=95, exif=exif.tobytes())
    photos = scan_photos(tmp_path, progress)
    (picture,) = photos.pictures()
    image = picture.load()
    assert photos.shape == image.shape[:2] == drawn.shape
    assert drawn.corners(image) == {"red": "upper left", "green": "lower right"}
    assert np.abs(image.astype(int) - drawn.draw(0)).mean() < 6


def test_photos_of_phones_are_named_where_nothing_reads_them(tmp_path, progress, monkeypatch):
    monkeypatch.setitem(sys.modules, "pillow_heif", None)
    (tmp_path / "IMG_1.HEIC").write_bytes(b"ftypheic")
    with pytest.raises(UserError, match="expected the package pillow-heif to read its HEIC photos, found none"):
        scan_photos(tmp_path, progress)
