"""Where the film of a rendered sequence lies."""

from __future__ import annotations

from threedfs.run_end.film import find_film


def test_twin_with_given_poses_has_the_film_of_its_take(tmp_path):
    film = tmp_path / "mug/00_render"
    film.mkdir(parents=True)
    assert find_film(tmp_path / "mug") == find_film(tmp_path / "mug_posed") == film
