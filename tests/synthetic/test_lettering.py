"""Exact tests of the lettering."""

import numpy as np

from threedfs.synthetic.lettering import ADVANCE, CHARACTERS, WIDTH, encode, letter_ink, text_ink
from threedfs.synthetic.textures import lettered, plain


def dots(letter):
    """Sample a letter at the middles of its dots, rows from the top down."""
    v, u = np.meshgrid((np.arange(7)[::-1] + 0.5) / 7, (np.arange(5) + 0.5) / 7, indexing="ij")
    code = np.full(35, CHARACTERS.index(letter))
    return letter_ink(code, u.ravel(), v.ravel(), np.zeros(35)).reshape(7, 5)


def test_letters_are_what_was_drawn():
    assert ["".join(".#"[int(dot)] for dot in row) for row in dots("F")] == [
        "#####",
        "#....",
        "#....",
        "####.",
        "#....",
        "#....",
        "#....",
    ]
    assert dots(" ").sum() == 0
    assert np.array_equal(dots("L")[-1], np.ones(5))


def test_no_two_letters_look_alike():
    drawn = {dots(letter).tobytes() for letter in CHARACTERS}
    assert len(drawn) == len(CHARACTERS)


def test_text_is_a_row_of_letters_around_its_middle():
    rng = np.random.default_rng(0)
    u, v = rng.uniform(0.001, WIDTH - 0.001, 200), rng.uniform(0, 1, 200)
    footprint = np.full(200, 0.02)
    start = -(3 * ADVANCE - (ADVANCE - WIDTH)) / 2
    for place, letter in enumerate("KEY"):
        shown = text_ink("key", 2 * (start + place * ADVANCE + u), 2 * (v - 0.5), 2.0, 2 * footprint)
        np.testing.assert_allclose(shown, letter_ink(np.full(200, encode(letter)[0]), u, v, footprint), atol=1e-9)
    assert not text_ink("KEY", np.array([-5.0, 5.0]), np.zeros(2), 1.0, np.zeros(2)).any()


def test_small_letters_become_grey_of_the_same_tone():
    u, v = np.random.default_rng(1).uniform(0, 1, (2, 20000))
    code = np.full(20000, CHARACTERS.index("B"))
    near = letter_ink(code, u * WIDTH, v, np.zeros(20000))
    far = letter_ink(code, u * WIDTH, v, np.ones(20000))
    assert np.ptp(far) == 0
    np.testing.assert_allclose(near.mean(), far.mean(), atol=0.08)  # strokes are rounded at their ends


def test_lettering_is_printed_line_by_line_where_it_belongs():
    paper, ink = plain((0.8, 0.7, 0.6), mottle=0.0), (0.1, 0.0, 0.2)
    right, up = np.array([0.0, 1, 0]), np.array([0.0, 0, 1])
    texture = lettered(paper, ink, ["AB", "C"], 0.01, (0.5, 0.2, 0.3), right, up)
    # The two middles of a line of one letter and of two, 1.6 heights apart, and a place beside the text.
    offsets = np.array([(0.0, -0.008), (0.0, 0.008), (0.03, 0.0)])
    points = np.array([0.5, 0.2, 0.3]) + offsets[:, :1] * right + offsets[:, 1:] * up
    cover = np.array([text_ink("C", 0 * points[:1, 0], np.zeros(1), 0.01, np.zeros(1))[0], 0.0, 0.0])
    expected = (1 - cover[:, None]) * (0.8, 0.7, 0.6) + cover[:, None] * ink
    np.testing.assert_allclose(texture(points, np.zeros(3)), expected, atol=1e-12)
    stroke = np.array([(0.5, 0.2 - 0.5 * 0.01 * WIDTH + 0.5 / 7 * 0.01, 0.3 - 0.008)])  # the left stroke of the C
    np.testing.assert_allclose(texture(stroke, np.zeros(1)), [ink], atol=1e-12)
    behind = stroke - [(0.02, 0, 0)]
    np.testing.assert_allclose(texture(behind, np.zeros(1)), [(0.8, 0.7, 0.6)])
