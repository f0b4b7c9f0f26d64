"""Lettering for labels and keys: capitals, digits and a few signs, drawn from dots."""

from __future__ import annotations

import numpy as np

# Five dots wide and seven high, rows from the top down; letters stand in the order of CHARACTERS.
CHARACTERS = " ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-=/.,'[]<>+"
_DOTS = """
..... .###. ####. .#### ####. ##### ##### .#### #...# .###. ..### #...# #.... #...# #...# .###. ####. .###. ####. .####
..... #...# #...# #.... #...# #.... #.... #.... #...# ..#.. ...#. #..#. #.... ##.## ##..# #...# #...# #...# #...# #....
..... #...# #...# #.... #...# #.... #.... #.... #...# ..#.. ...#. #.#.. #.... #.#.# ##..# #...# #...# #...# #...# #....
..... ##### ####. #.... #...# ####. ####. #..## ##### ..#.. ...#. ##... #.... #.#.# #.#.# #...# ####. #...# ####. .###.
..... #...# #...# #.... #...# #.... #.... #...# #...# ..#.. ...#. #.#.. #.... #...# #..## #...# #.... #.#.# #.#.. ....#
..... #...# #...# #.... #...# #.... #.... #...# #...# ..#.. #..#. #..#. #.... #...# #..## #...# #.... #..#. #..#. ....#
..... #...# ####. .#### ####. ##### #.... .###. #...# .###. .##.. #...# ##### #...# #...# .###. #.... .##.# #...# ####.

##### #...# #...# #...# #...# #...# ##### .###. ..#.. .###. .###. ...#. ##### .###. ##### .###. .###. ..... ..... .....
..#.. #...# #...# #...# #...# #...# ....# #...# .##.. #...# #...# ..##. #.... #.... ....# #...# #...# ..... ..... ....#
..#.. #...# #...# #...# .#.#. .#.#. ...#. #..## ..#.. ....# ....# .#.#. ####. #.... ...#. #...# #...# ..... ##### ...#.
..#.. #...# #...# #.#.# ..#.. ..#.. ..#.. #.#.# ..#.. ...#. ..##. #..#. ....# ####. ..#.. .###. .#### ##### ..... ..#..
..#.. #...# .#.#. #.#.# .#.#. ..#.. .#... ##..# ..#.. ..#.. ....# ##### ....# #...# ..#.. #...# ....# ..... ##### .#...
..#.. #...# .#.#. ##.## #...# ..#.. #.... #...# ..#.. .#... #...# ...#. #...# #...# ..#.. #...# ....# ..... ..... #....
..#.. .###. ..#.. #...# #...# ..#.. ##### .###. .###. ##### .###. ...#. .###. .###. ..#.. .###. .###. ..... ..... .....

..... ..... ..#.. .###. .###. ...#. .#... .....
..... ..... ..#.. .#... ...#. ..#.. ..#.. ..#..
..... ..... ..... .#... ...#. .#... ...#. ..#..
..... ..... ..... .#... ...#. #.... ....# #####
..... ..... ..... .#... ...#. .#... ...#. ..#..
..##. ..#.. ..... .#... ...#. ..#.. ..#.. ..#..
..##. .#... ..... .###. .###. ...#. .#... .....
"""
# Width and stroke of a letter, and the step to the next one, in letter heights.
WIDTH, STROKE, ADVANCE = 5 / 7, 1 / 7, 6 / 7


def _read_dots() -> np.ndarray:
    """Return the letters as (L, 9, 7) float64 with a rim of zeros, rows from the bottom up."""
    rows = [np.array([list(letter) for line in block.splitlines() for letter in line.split()]) for block in _BLOCKS]
    letters = [block.reshape(7, -1, 5).swapaxes(0, 1)[:, ::-1] == "#" for block in rows]
    return np.pad(np.concatenate(letters).astype(float), ((0, 0), (1, 1), (1, 1)))


_BLOCKS = _DOTS.strip().split("\n\n")
_LETTERS = _read_dots()


def encode(text: str) -> np.ndarray:
    """Return the letters (N,) int64 of a text as indices into CHARACTERS; what is not there becomes a space."""
    return np.array([max(CHARACTERS.find(letter), 0) for letter in text.upper()], np.int64)


def letter_ink(letter: np.ndarray, u: np.ndarray, v: np.ndarray, footprint: np.ndarray) -> np.ndarray:
    """Return the share of ink (N,) in [0, 1] at places inside letters.

    Parameters
    ----------
    letter : (N,) int64
        Index into CHARACTERS.
    u, v : (N,) float64
        To the right and up from the letter's lower left corner, in letter heights.
    footprint : (N,) float64
        Size of a pixel, in letter heights; strokes that it cannot resolve become grey.
    """
    x, y = np.clip(u * 7 + 0.5, 0, 5.999), np.clip(v * 7 + 0.5, 0, 7.999)
    i, j = x.astype(int), y.astype(int)
    a, b = x - i, y - j
    low = (1 - a) * _LETTERS[letter, j, i] + a * _LETTERS[letter, j, i + 1]
    high = (1 - a) * _LETTERS[letter, j + 1, i] + a * _LETTERS[letter, j + 1, i + 1]
    sharp = np.clip(((1 - b) * low + b * high - 0.5) / np.clip(7 * footprint, 0.25, 1) + 0.5, 0, 1)
    resolved = np.clip(2 - 7 * footprint, 0, 1)
    inside = (u > 0) & (u < WIDTH) & (v > 0) & (v < 1)
    grey = _LETTERS.sum(axis=(1, 2))[letter] / 35 * inside
    return grey + (sharp - grey) * resolved


def text_ink(text: str, u: np.ndarray, v: np.ndarray, height: float, footprint: np.ndarray) -> np.ndarray:
    """Return the share of ink (N,) of one line of text whose middle is at (0, 0), its letters `height` high."""
    letters = encode(text)
    across = u / height + (len(letters) * ADVANCE - (ADVANCE - WIDTH)) / 2
    place = np.floor(across / ADVANCE).astype(int)
    on_line = (place >= 0) & (place < len(letters))
    letter = np.where(on_line, letters[np.clip(place, 0, len(letters) - 1)], 0)
    return letter_ink(letter, across - place * ADVANCE, v / height + 0.5, footprint / height)
