"""Exact and rejection: what a user may ask for on the command line."""

from pathlib import Path

import pytest

from threedfs.cli.request import (
    list_requests,
    make_configuration,
    name_sequence,
    read_height,
    read_scale,
    read_settings,
)
from threedfs.errors import UserError
from threedfs.params.sequences import RUN_FILES


@pytest.mark.parametrize(
    ("text", "millimetres"), [("95mm", 95), ("9.5cm", 95), ("0.095m", 95), ("95", 95), (" 2 in ", 50.8), (".5m", 500)]
)
def test_a_height_is_read_in_its_unit(text, millimetres):
    assert read_height(text) == pytest.approx(millimetres)


@pytest.mark.parametrize("text", ["", "0mm", "-3cm", "tall", "nan", "inf", "1e999mm", "3 feet", "9,5cm", "mm"])
def test_what_is_no_height_is_refused(text):
    with pytest.raises(UserError, match="--height: expected a length"):
        read_height(text)


@pytest.mark.parametrize(
    ("flags", "entry"),
    [
        (("40mm", None, None), {"tag": "40mm"}),
        ((None, "9x6:25mm", None), {"board": {"corners": [9, 6], "square": "25mm"}}),
        ((None, None, "9.5cm"), {"height": "9.5cm"}),
        ((None, None, None), None),
    ],
)
def test_what_tells_the_size_goes_into_the_configuration(tmp_path, flags, entry):
    (tmp_path / "mug.mp4").touch()
    assert read_scale(*flags) == entry
    (own,) = make_configuration(list_requests([str(tmp_path / "mug.mp4")], entry), {})["sequences"].values()
    assert own.get("scale") == entry


@pytest.mark.parametrize(
    ("flags", "said"),
    [
        (("big", None, None), "--tag: expected a length"),
        ((None, "9x6", None), "--board: expected inner corners .*9x6:25mm"),
        ((None, "2x6:25mm", None), "--board: expected inner corners"),
        ((None, "9x6:wide", None), "--board: expected a length"),
    ],
)
def test_what_tells_no_size_is_refused(flags, said):
    with pytest.raises(UserError, match=said):
        read_scale(*flags)


@pytest.mark.parametrize(
    ("file", "name"),
    [
        ("My Video (1).mov", "My_Video_1"),
        ("mug.mp4", "mug"),
        ("VID_20260101.MOV", "VID_20260101"),
        ("Straße 5.mp4", "Stra_e_5"),
        ("(((.mp4", "video_a1f7c81a"),
        ("<script>.mp4", "script"),
        ("..mp4", "video_0ed4e242"),
    ],
)
def test_any_file_gets_a_name_that_can_be_a_folders(file, name):
    assert name_sequence(Path(file)) == name


@pytest.mark.parametrize("taken", sorted(RUN_FILES))
def test_no_name_is_one_that_the_run_itself_writes(taken):
    assert name_sequence(Path(f"{taken}.mp4")) not in RUN_FILES


def test_two_videos_of_one_name_are_refused(tmp_path):
    for name in ("a b.mp4", "a(b).mp4"):
        (tmp_path / name).touch()
    with pytest.raises(UserError, match="expected a name of its own"):
        list_requests([str(tmp_path / "a b.mp4"), str(tmp_path / "a(b).mp4")])


def test_a_video_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(UserError, match="found nothing there"):
        list_requests([str(tmp_path / "lost.mp4")])


def test_settings_make_a_configuration(tmp_path):
    (tmp_path / "mug.mp4").touch()
    changes = read_settings(["depth.iterations=5", "depth.prior=robust", "methods=[tsdf]", "crops.whole=true"])
    assert changes == {"depth": {"iterations": 5, "prior": "robust"}, "methods": ["tsdf"], "crops": {"whole": True}}
    made = make_configuration(list_requests([str(tmp_path / "mug.mp4")]), changes)
    assert made["sequences"] == {"mug": {"source": str(tmp_path / "mug.mp4")}}
    assert made["crops"] == {"whole": True}


@pytest.mark.parametrize("change", ["depth.iterations", "=5", "a.b.c=5", ".x=1", "depth.=1", "depth.iterations=[1"])
def test_what_is_no_setting_is_refused(change):
    with pytest.raises(UserError, match="--set: expected"):
        read_settings([change])


def test_a_section_and_a_value_of_one_name_are_refused():
    with pytest.raises(UserError, match="was given one value before"):
        read_settings(["depth=5", "depth.iterations=5"])
