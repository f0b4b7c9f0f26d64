"""Where the film of a rendered sequence lies."""

from __future__ import annotations

from threedfs.run_end.film import find_film


def write_frames(results, content):
    (results / "01_frames").mkdir(parents=True)
    (results / "01_frames/frames.zarr.zip").write_text(content)


def test_a_sequence_without_a_film_has_that_of_the_one_with_its_frames(tmp_path):
    for name, content in (("cup", "cup"), ("mug", "mug"), ("mug_posed", "mug")):
        write_frames(tmp_path / name, content)
    for name in ("cup", "mug"):
        (tmp_path / name / "00_render").mkdir()
    film = tmp_path / "mug/00_render"
    assert find_film(tmp_path / "mug") == find_film(tmp_path / "mug_posed") == film


def test_a_sequence_that_was_not_rendered_has_none(tmp_path):
    write_frames(tmp_path / "mug", "mug")
    write_frames(tmp_path / "vase", "vase")
    (tmp_path / "mug/00_render").mkdir()
    assert not find_film(tmp_path / "vase").exists() and not find_film(tmp_path / "lost").exists()
