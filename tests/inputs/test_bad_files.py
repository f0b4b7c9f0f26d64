"""Rejection: files that cannot be used, each with the words that its sentence must have."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from specimens import COLUMNS, COUNT, ROWS, cameras, disc, write_mask

from threedfs.errors import UserError
from threedfs.inputs.check import find_fault
from threedfs.inputs.look import look
from threedfs.io.given_cameras import read_given_cameras
from threedfs.io.given_meshes import read_given_mesh

FRAMES = {"min_frames": 8, "max_frames": 150, "longest_side": 960}
NOISE = np.random.default_rng(2).integers(0, 255, (ROWS, COLUMNS, 3), dtype=np.uint8)
GREY = np.random.default_rng(3).integers(60, 200, (ROWS, COLUMNS), dtype=np.uint8)


def file(name: str, content: bytes | str) -> Callable[[Path, Path], Path]:
    """Return what writes a file."""

    def make(folder: Path, sound: Path) -> Path:
        (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)
        return folder / name

    return make


def changed(where: str = "", **values: object) -> Callable[[Path, Path], Path]:
    """Return what writes cameras.json with other values: of all cameras, or of one."""

    def make(folder: Path, sound: Path) -> Path:
        content = cameras()
        (content["frames"][int(where)] if where else content).update(values)
        (folder / "cameras.json").write_text(json.dumps(content))
        return folder / "cameras.json"

    return make


def pose(row: int, column: int, value: float) -> Callable[[Path, Path], Path]:
    """Return what writes cameras.json with one number of a pose changed."""
    matrix = cameras()["frames"][0]["cam_to_world"]
    matrix[row][column] = value
    return changed("0", cam_to_world=matrix)


def without(key: str) -> Callable[[Path, Path], Path]:
    """Return what writes cameras.json without a key."""

    def make(folder: Path, sound: Path) -> Path:
        content = cameras()
        del content[key]
        (folder / "cameras.json").write_text(json.dumps(content))
        return folder / "cameras.json"

    return make


def images(names: dict[str, np.ndarray]) -> Callable[[Path, Path], Path]:
    """Return what makes a folder of images."""

    def make(folder: Path, sound: Path) -> Path:
        for name, image in names.items():
            Image.fromarray(image).save(folder / name)
        return folder

    return make


def masks(
    draw: Callable[[int], np.ndarray], levels: int = 255, kind: type = np.uint8, name: str = "{:06d}"
) -> Callable[[Path, Path], Path]:
    """Return what makes a folder of masks, each drawn by its number."""

    def make(folder: Path, sound: Path) -> Path:
        for number in range(COUNT):
            write_mask(folder / f"{name.format(number)}.png", draw(number), levels, kind)
        return folder

    return make


def copied(part: float, kind: str) -> Callable[[Path, Path], Path]:
    """Return what copies the first part of a sound file."""

    def make(folder: Path, sound: Path) -> Path:
        data = (sound / kind).read_bytes()
        (folder / kind).write_bytes(data[: int(part * len(data))])
        return folder / kind

    return make


def moved(scale: float, shift: float) -> Callable[[Path, Path], Path]:
    """Return what writes the sound mesh elsewhere."""

    def make(folder: Path, sound: Path) -> Path:
        mesh = read_given_mesh(sound / "mesh.ply")
        lines = [f"v {x} {y} {z}" for x, y, z in mesh.vertices * (scale, 1, 1) + shift]
        (folder / "mesh.obj").write_text("\n".join([*lines, *(f"f {a} {b} {c}" for a, b, c in mesh.faces + 1)]))
        return folder / "mesh.obj"

    return make


def few_cameras(count: int) -> Callable[[Path, Path], Path]:
    return changed(frames=cameras()["frames"][:count])


def spoil(folder: Path, numbers: Iterable[int]) -> Path:
    """Cut photos of a folder off; return the folder."""
    for number in numbers:
        photo = folder / f"{number}.png"
        photo.write_bytes(photo.read_bytes()[:20])
    return folder


PHOTO = {f"{number}.png": NOISE for number in range(COUNT)}
TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
PLY = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
NO_JSON = "got a file that is no JSON"
NO_CAMERAS = "got a file whose entries are no cameras"

CAMERAS = {
    "empty": (file("c.json", ""), NO_JSON),
    "no text": (file("c.json", b"\xff\xfe\x00\x9f"), NO_JSON),
    "deep": (file("c.json", "[" * 100_000), NO_JSON),
    "list": (file("c.json", "[]"), NO_CAMERAS),
    "number": (file("c.json", "3"), NO_CAMERAS),
    "no frames": (file("c.json", "{}"), "without the key 'frames'"),
    "frames are text": (changed(frames="abc"), NO_CAMERAS),
    "frames are null": (changed(frames=None), NO_CAMERAS),
    "frame is null": (changed(frames=[None]), NO_CAMERAS),
    "no cameras": (changed(frames=[]), "expected at least one camera, got none"),
    "no width": (without("width"), "without the key 'width'"),
    "width is text": (changed(width="wide"), NO_CAMERAS),
    "width of infinity": (changed(width=float("inf")), NO_CAMERAS),
    "width of NaN": (changed(width=float("nan")), NO_CAMERAS),
    "enormous width": (changed(width=10**12), "expected images of 1 to 100000 pixels a side, got 1000000000000x48"),
    "negative height": (changed(height=-48), "expected images of 1 to 100000 pixels a side"),
    "k1 of NaN": (changed(k1=float("nan")), "expected finite numbers, got fx, fy, cx, cy, k1, k2 of 60, 60"),
    "centre of infinity": (changed(cx=float("inf")), "expected finite numbers"),
    "no focal length": (changed(fx=0), "expected positive focal lengths in pixels, got 0 and 60"),
    "negative focal length": (changed(fy=-60), "expected positive focal lengths"),
    "twice": (changed(frames=cameras()["frames"][:1] * 3), "expected one camera of each image, got 3 of 0"),
    "pose of NaN": (pose(0, 3, float("nan")), "000000: expected finite numbers"),
    "pose with a scale": (pose(0, 0, 9.0), "expected a rotation in the upper left 3x3 block"),
    "pose transposed": (pose(3, 0, 2.0), "expected the last row (0, 0, 0, 1)"),
    "pose of three rows": (changed("0", cam_to_world=np.eye(4)[:3].tolist()), "expected shape (4, 4), got (3, 4)"),
    "pose of text": (changed("0", cam_to_world="eye"), NO_CAMERAS),
    "empty folder": (lambda folder, sound: folder, "found none of them in this folder"),
    "no COLMAP model": (file("images.bin", b"\x01"), "got files that COLMAP cannot read"),
    "CONTOUR without numbers": (file("a.txt", "CONTOUR\n"), "expected CONTOUR and the 12 numbers"),
    "CONTOUR of zeros": (file("a.txt", "CONTOUR\n" + "0 " * 12), "got a singular matrix"),
    "no pose line": (file("a.pose", "1 2 3\n"), "expected a unit quaternion, w first, and a translation"),
    "absent": (lambda folder, sound: folder / "c.json", "expected given cameras"),
}
MESHES = {
    "empty": (file("m.ply", b""), "expected a triangle mesh, got something that cannot be read"),
    "text": (file("m.ply", "hello"), "expected a triangle mesh, got something that cannot be read"),
    "cut off": (copied(0.5, "mesh.ply"), "expected a triangle mesh, got something that cannot be read"),
    "unknown ending": (file("m.xyzzy", "hello"), "expected a triangle mesh, got something that cannot be read"),
    "folder": (lambda folder, sound: folder, "expected a mesh file, found none"),
    "cloud": (file("m.ply", f"{PLY}end_header\n0 0 0\n1 0 0\n0 1 0\n"), "without faces; mesh them"),
    "NaN": (file("m.obj", TRIANGLE.replace("1 0 0", "nan 0 0") + "f 1 2 3\n"), "vertices that are finite numbers"),
    "infinity": (file("m.obj", TRIANGLE.replace("1 0 0", "inf 0 0") + "f 1 2 3\n"), "vertices that are finite numbers"),
    "no such vertex": (file("m.obj", TRIANGLE + "f 1 2 9\n"), "cannot be read"),
    "on a line": (file("m.obj", TRIANGLE.replace("0 1 0", "3 0 0") + "f 1 2 3\n"), "expected a surface with an area"),
    "in a point": (file("m.obj", "v 1 2 3\n" * 3 + "f 1 2 3\n"), "expected a surface with an area"),
    "far too large": (file("m.obj", "v 0 0 0\nv 1e200 0 0\nv 0 1e200 0\nf 1 2 3\n"), "expected a surface with an area"),
}
SEQUENCES = {
    ("source", "empty"): (file("v.mp4", b""), "got an empty file; copy it again"),
    ("source", "text"): (file("v.mp4", "hello " * 99), "got a file"),
    ("source", "cut off"): (copied(0.1, "video.mp4"), "expected a video"),
    ("source", "list of files"): (file("v.mp4", "ffconcat version 1.0\nfile a.mp4\n"), "expected a video"),
    ("source", "single picture"): (
        lambda folder, sound: sound / "photos/000001.png",
        "got a single picture; put all photos into a folder",
    ),
    ("source", "mesh"): (lambda folder, sound: sound / "mesh.ply", "expected a video (mp4 or mov)"),
    ("source", "empty folder"): (lambda folder, sound: folder, "got a folder without such files"),
    ("source", "other files"): (
        lambda folder, sound: file("IMG_1.DNG", "x")(folder, sound).parent,
        "it has files that end in dng; convert them to jpg",
    ),
    ("source", "few photos"): (
        images({f"{number}.png": NOISE for number in range(3)}),
        "expected at least 8 frames, got 3; take more photos",
    ),
    ("source", "16-bit grey"): (
        images({f"{number}.png": np.zeros((9, 9), np.uint16) for number in range(COUNT)}),
        "expected photos with 8 bits a channel, got 12 files of 16-bit or real-valued grey",
    ),
    ("source", "corrupt photos"): (
        lambda folder, sound: spoil(images(PHOTO)(folder, sound), range(5)),
        "expected at least 8 frames, got 7 and 5 that cannot be read; take more photos",
    ),
    ("source", "braces"): (images(PHOTO | {"{x}.png": NOISE}), "got '{x}.png'; rename it"),
    ("source", "line break"): (images(PHOTO | {"a\nb.png": NOISE}), "got 'a\\nb.png'; rename it"),
    ("source", "long name"): (images(PHOTO | {f"{'a' * 200}.png": NOISE}), "rename it to at most 150 letters"),
    ("source", "one name twice"): (images(PHOTO | {"1.bmp": NOISE}), "got several named '1'"),
    ("calibration", "text"): (file("v.mp4", "hello " * 99), "expected a video"),
    ("cameras", "few"): (few_cameras(3), "expected given cameras for at least 6 of the 12 frames, got 3"),
    ("cameras", "of other frames"): (
        changed(frames=[{**frame, "video_frame": 900 + i} for i, frame in enumerate(cameras()["frames"])]),
        "expected given cameras for at least two frames, got 0 of 12",
    ),
    ("cameras", "upright"): (changed(width=ROWS, height=COLUMNS), "got 48x64 for frames of 64x48"),
    ("cameras", "two lenses"): (changed("3", k1=0.1), "expected one radial distortion for all given cameras"),
    ("truth_cameras", "of other frames"): (
        changed(frames=[{**frame, "video_frame": 900 + i} for i, frame in enumerate(cameras()["frames"])]),
        "expected given cameras for at least two frames, got 0 of 12",
    ),
    ("truth_cameras", "upright"): (changed(width=ROWS, height=COLUMNS), "cameras.json: expected given cameras for"),
    ("truth_cameras", "broken"): (file("c.json", "{"), NO_JSON),
    ("truth_masks", "file"): (file("m.png", "x"), "expected a folder of masks, found none"),
    ("truth_masks", "no images"): (lambda folder, sound: folder, "got 0 png files none of which belongs to a frame"),
    ("truth_masks", "other names"): (masks(lambda number: disc(), name="mask{}"), "expected masks named after frames"),
    ("truth_masks", "other size"): (
        masks(lambda number: disc()[:40]),
        "expected a mask of the size of the source frames, 64x48 pixels, got 64x40",
    ),
    ("truth_masks", "no image"): (file("000000.png", "x"), "expected a folder of masks"),
    ("truth_masks", "levels 0 and 1"): (masks(lambda number: disc(), 1), "got levels up to 1 only; multiply them"),
    ("truth_masks", "one of levels 0 and 1"): (
        lambda folder, sound: (
            masks(lambda number: disc())(folder, sound),
            write_mask(folder / "000003.png", disc(), 1),
        )[0],
        "000003.png: expected a white object (level 255) on black, got levels up to 1 only",
    ),
    ("truth_masks", "16 bits"): (masks(lambda n: disc(), 255, np.uint16), "got levels up to 255 of 65535 only"),
    ("truth_masks", "black"): (masks(lambda number: disc(0)), "got 12 that are black all over"),
    ("truth_masks", "white"): (
        masks(lambda number: disc(99)),
        "000000.png: expected a white object on black, got white",
    ),
    ("truth_masks", "inverted"): (masks(lambda number: ~disc()), "got 12 of 12 masks that are white along the border"),
    ("truth_masks", "photographs"): (images({f"{n}.png": GREY for n in range(COUNT)}), "is it a photograph?"),
    ("truth_depth", "no images"): (lambda folder, sound: folder, "expected depth images named after frames"),
    ("truth_depth", "other size"): (
        images({f"{n:06d}.depth.png": np.ones((9, 9), np.uint16) for n in range(COUNT)}),
        "expected a depth image of 64 x 48 pixels",
    ),
    ("truth_depth", "8 bits"): (
        images({f"{n:06d}.depth.png": GREY for n in range(COUNT)}),
        "expected one channel of 16-bit depths",
    ),
    ("truth_depth", "no depth"): (
        images({f"{n:06d}.depth.png": np.zeros((ROWS, COLUMNS), np.uint16) for n in range(COUNT)}),
        "expected depth images, got 3 without any depth",
    ),
    ("truth_mesh", "elsewhere"): (moved(1, 1000), "got one that none of them sees (of 12 asked)"),
    ("truth_mesh", "no area"): (file("m.obj", "v 1 2 3\n" * 3 + "f 1 2 3\n"), "expected a surface with an area"),
}


@pytest.mark.parametrize("case", CAMERAS)
def test_cameras_that_cannot_be_used(tmp_path, sound, case):
    make, words = CAMERAS[case]
    path = make(tmp_path, sound)
    with pytest.raises(UserError) as fault:
        read_given_cameras(path.parent if path.suffix in (".bin", ".txt") else path)
    assert words in str(fault.value) and str(tmp_path) in str(fault.value)


@pytest.mark.parametrize("case", MESHES)
def test_meshes_that_cannot_be_used(tmp_path, sound, case):
    make, words = MESHES[case]
    with pytest.raises(UserError) as fault:
        read_given_mesh(make(tmp_path, sound))
    assert words in str(fault.value) and str(tmp_path) in str(fault.value)


@pytest.mark.parametrize("case", SEQUENCES, ids="-".join)
def test_files_that_a_sequence_cannot_use(tmp_path, sound, entry, case):
    make, words = SEQUENCES[case]
    (tmp_path / "given").mkdir()
    given = {**entry, case[0]: str(make(tmp_path / "given", sound))}
    if case[0] == "source":  # what else there is belongs to the video
        given |= dict.fromkeys(set(entry) - {"source", "depth_scale"})
    fault, notes = find_fault(given, FRAMES, tmp_path / "memory")
    assert words in fault and not notes
    assert not (tmp_path / "memory").exists()


def test_sound_inputs_pass_and_are_looked_at_once(tmp_path, sound, entry, monkeypatch):
    assert find_fault(entry, FRAMES, tmp_path) == ("", ())
    monkeypatch.setattr("threedfs.inputs.look.look", lambda *given: pytest.fail("looked again"))
    assert find_fault(entry, FRAMES, tmp_path) == ("", ())


def test_an_edited_file_is_looked_at_again(tmp_path, sound, entry):
    shutil.copy(sound / "mesh.ply", tmp_path / "mesh.ply")
    given = {**entry, "truth_mesh": str(tmp_path / "mesh.ply")}
    assert find_fault(given, FRAMES, tmp_path / "memory") == ("", ())
    (tmp_path / "mesh.ply").write_text("spoilt")
    assert "mesh.ply: expected a triangle mesh" in find_fault(given, FRAMES, tmp_path / "memory")[0]


def test_a_file_that_cannot_be_opened_is_named(tmp_path, entry, monkeypatch):
    def deny(*given):
        raise PermissionError(13, "Permission denied", "/x/cameras.json")

    monkeypatch.setattr("threedfs.inputs.look.look", deny)
    fault, _ = find_fault(entry, FRAMES, tmp_path)
    assert fault == "/x/cameras.json: expected a file that can be read, got Permission denied; check the file."


def test_a_file_dated_in_the_future_is_refused(tmp_path, sound, entry):
    shutil.copy(sound / "video.mp4", tmp_path / "video.mp4")
    os.utime(tmp_path / "video.mp4", (4e9, 4e9))
    fault, _ = find_fault({**entry, "source": str(tmp_path / "video.mp4")}, FRAMES, tmp_path / "memory")
    assert "video.mp4: expected a file of the past, got one of 2096-" in fault and "touch" in fault


def test_some_empty_masks_pass(tmp_path, sound, entry):
    folder = masks(lambda number: disc(0 if number < 11 else 12))(tmp_path, sound)
    assert look({**entry, "truth_masks": str(folder)}, FRAMES) == []


def test_a_mesh_of_something_else_is_noted(tmp_path, sound, entry):
    (note,) = look({**entry, "truth_mesh": str(moved(4, 0)(tmp_path, sound))}, FRAMES)
    assert "the true mesh covers other places than the true masks" in note


def test_names_that_people_give_to_photos_pass(tmp_path, sound, entry):
    names = ["IMG 1", "mom's", "(1)", "a,b", "é", "[x]", "a=b", "50%", "#7", "a;b", "-1", "a.b"]
    folder = images({f"{name}.png": NOISE for name in names})(tmp_path, sound)
    assert look({**dict.fromkeys(entry), "source": str(folder)}, FRAMES) == []


def test_a_name_with_a_colon_is_no_address(tmp_path, sound, entry):
    shutil.copy(sound / "video.mp4", tmp_path / "take:1.mp4")
    assert look({**entry, "source": str(tmp_path / "take:1.mp4")}, FRAMES) == []
