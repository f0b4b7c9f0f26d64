"""Property tests of the takes of Tabletop-12: what they are made of, how they are framed, what they leave out."""

from __future__ import annotations

import ast
import importlib.util
import re
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from ball import ball_solid

from threedfs.errors import UserError
from threedfs.synthetic import takes
from threedfs.synthetic.render import Renderer
from threedfs.synthetic.solid import Material
from threedfs.synthetic.tabletop import SECONDS, walk
from threedfs.synthetic.takes import list_takes, make_take, take_module
from threedfs.synthetic.textures import plain
from threedfs.synthetic.things import card, lay_around, note, page

FOLDER = Path(takes.__file__).parent
NAMES = (
    "books dragon godzilla1 godzilla2 hedgehog1 hedgehog2 helmet keyboard paper_punch rubik_cube stapler teabox".split()
)
WHITE = Material(plain((0.5, 0.5, 0.5), 0.0))


@pytest.fixture(scope="module")
def coarse():
    """Film the cube with a coarse renderer."""
    take = make_take("rubik_cube")
    film = take.film(24, 96, 1)
    return take, film, Renderer(film.scene, 2, 2, 0.01)


def test_there_are_twelve_takes_and_others_are_refused_by_name():
    assert list(list_takes()) == NAMES
    with pytest.raises(UserError, match=r"expected one of books, dragon, .* got 'mug'"):
        take_module("mug")


def test_no_seed_is_used_twice():
    """No two takes share a texture, and nothing in a take looks like another thing in it."""
    used = Counter()
    for name in NAMES:
        text = (FOLDER / f"{name}.py").read_text()
        things = re.findall(r"\b(?:page|card|napkin|note|wrapping)\((\d+)", text)
        used.update({int(seed) for seed in things + re.findall(r"seed=(\d+)", text)})
        assert len(things) == len(set(things)) >= 4
    assert not [seed for seed, count in used.items() if count > 1]


@pytest.mark.parametrize("name", NAMES)
def test_a_take_makes_its_object_from_one_module(name):
    """What a stage does not import by name cannot count as its code: `make_take` names all that it needs."""
    tree = ast.parse((FOLDER / f"{name}.py").read_text())
    modules = [node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
    (own,) = (module for module in modules if module.startswith("threedfs.synthetic.objects."))
    assert own.rpartition(".")[2] == name.rstrip("12")


def test_second_takes_differ_in_path_light_and_surface():
    for name in ("hedgehog", "godzilla"):
        lines = [(FOLDER / f"{name}{number}.py").read_text().splitlines() for number in (1, 2)]
        for start in ("    support =", "    light =", "    path ="):
            first, second = ([line for line in text if line.startswith(start)] for text in lines)
            assert first and first != second


def test_the_object_stays_in_sight_and_fills_its_share(coarse):
    _, film, renderer = coarse
    shares = []
    for frame in range(film.frames):
        rows, columns = np.nonzero(renderer.mask(film.view(frame)))
        assert rows.min() > 0 and rows.max() < 71 and columns.min() > 0 and columns.max() < 95
        shares.append(np.ptp(columns) / 96)
    assert 0.2 < np.mean(shares) < 0.36
    assert film.rate * SECONDS == film.frames


def test_unseen_views_see_the_object_from_where_the_camera_never_was(coarse):
    take, film, renderer = coarse
    path = np.array([film.view(frame).centre for frame in range(film.frames)])
    views = take.unseen(96, 24)
    assert [view.name for view in views] == [f"unseen_{index:02d}" for index in range(24)]
    target = np.array(take.path.target)
    azimuths = sorted(np.degrees(np.arctan2(*(view.centre - target)[1::-1])) for view in views)
    assert max(np.diff([*azimuths, azimuths[0] + 360])) < 30
    for view in views:
        assert renderer.mask(view).mean() > 0.01
        assert np.linalg.norm(path - view.centre, axis=1).min() > 0.02 * take.path.distance[0]
        reach = np.linalg.norm(view.centre - target)
        assert not take.path.distance[0] * 0.95 < reach < take.path.distance[1] * 1.05
    repeated = take.unseen(96, 24)
    assert all(np.array_equal(a.cam_from_world, b.cam_from_world) for a, b in zip(views, repeated, strict=True))


def test_fewer_frames_show_the_same_walk(coarse):
    few, many = (coarse[0].film(frames, 96, 1) for frames in (12, 120))
    np.testing.assert_allclose(few.view(5).cam_from_world, many.view(50).cam_from_world, atol=1e-12)


def test_a_walk_keeps_a_ball_at_its_share_of_the_width():
    """A ball of radius r at distance d is 2 r / sqrt(d^2 - r^2) focal lengths wide."""
    solid = ball_solid(4, WHITE)
    path = walk(solid, seed=1, start=0.0, turns=1.0, share=(0.25, 0.33))
    wide = [2 * 0.1 / np.sqrt(d**2 - 0.1**2) * 525 / 640 for d in path.distance]
    assert wide == pytest.approx([0.33, 0.25], rel=0.03)


def test_things_lie_apart_from_the_object_and_as_near_as_their_gap():
    solid = ball_solid(4, WHITE)
    things = (page(1), card(2), note(3), page(4, (0.05, 0.07)))
    sheets = lay_around(solid, things, seed=5, gap=(0.01, 0.02))
    assert [sheet.half for sheet in sheets] == [thing.half for thing in things]
    for sheet in sheets:
        apart = np.max(np.abs(sheet.local(solid.mesh.vertices)[:, :2]) - sheet.half, axis=1).min()
        assert 0.01 - 1e-3 <= apart <= 0.03
    again = lay_around(solid, things, seed=5, gap=(0.01, 0.02))
    assert [sheet.centre for sheet in again] == [sheet.centre for sheet in sheets]


@pytest.mark.parametrize("name", NAMES)
def test_every_take_has_its_object(name):
    assert importlib.util.find_spec(f"threedfs.synthetic.objects.{name.rstrip('12')}") is not None
