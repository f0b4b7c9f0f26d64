"""Property tests of the noise and of textures made from it."""

import numpy as np
import pytest

from threedfs.synthetic.noise import cell_noise, fractal_noise, hash_cells
from threedfs.synthetic.textures import plain, printed, scaly, speckled, streaked, wood, woven

POINTS = np.column_stack([np.random.default_rng(0).uniform(-3, 3, (20000, 2)), np.zeros(20000)])


def test_noise_is_bounded_and_centred():
    value = fractal_noise(POINTS, 0.0, 0.05, 4)
    assert np.all(np.abs(value) <= 1)
    assert abs(value.mean()) < 0.02  # about 14000 independent cells, standard deviation 0.25 each
    assert value.std() > 0.1


def test_noise_is_continuous_across_lattice_cells():
    shift = np.array([1e-7, 0, 0])
    edge = np.array([[0.05, 0.013, 0.0]])
    jump = fractal_noise(edge + shift, 0.0, 0.05) - fractal_noise(edge - shift, 0.0, 0.05)
    assert abs(jump[0]) < 1e-3  # slope is below about 100 per unit for five octaves


def test_octaves_finer_than_the_pixel_vanish():
    assert np.all(fractal_noise(POINTS, 0.05, 0.05, 4) == 0)
    coarse = fractal_noise(POINTS, 0.0, 0.05, 1, seed=3)
    four = fractal_noise(POINTS, 0.025, 0.05, 4, gain=0.5, seed=3)
    np.testing.assert_allclose(four, coarse / (1 + 0.5 + 0.25 + 0.125), atol=1e-12)


def test_noise_does_not_repeat():
    """Patches of one texture at many places, and of two seeds at one place, are uncorrelated."""
    patch = np.column_stack([np.random.default_rng(1).uniform(0, 0.5, (4000, 2)), np.zeros(4000)])
    here = fractal_noise(patch, 0.0, 0.02, 3)
    shifts = [[1, 0, 0], [0, 1, 0], [12.8, 0, 0], [0, 25.6, 0], [655.36, 0, 0]]
    others = [fractal_noise(patch + shift, 0.0, 0.02, 3) for shift in shifts]
    others.append(fractal_noise(patch, 0.0, 0.02, 3, seed=1000))
    for other in others:
        # 625 cells in a patch: the standard error of a correlation is 0.04.
        assert abs(np.corrcoef(here, other)[0, 1]) < 0.2


def test_cells_have_their_own_uniform_numbers():
    i, j = np.meshgrid(np.arange(200), np.arange(-100, 100), indexing="ij")
    number = hash_cells(i.ravel(), j.ravel(), seed=4)
    counts, _ = np.histogram(number, 10, (0, 1))
    assert len(np.unique(number)) > 0.999 * number.size
    assert np.all(np.abs(counts - 4000) < 300)  # five standard deviations of a count of 4000


def test_cells_divide_space_by_the_nearest_seed():
    points = np.random.default_rng(2).uniform(-1, 1, (20000, 3))
    first, second, name = cell_noise(points, 0.5, seed=6)
    assert np.all(first <= second) and first.max() < 1.3  # a seed in every unit cube, off its faces
    again, _, same = cell_noise(points + 1e-9, 0.5, seed=6)
    inner = second - first > 1e-6
    np.testing.assert_array_equal(name[inner], same[inner])
    np.testing.assert_allclose(first, again, atol=1e-8)  # distances pass smoothly from cell to cell
    # About 4^3 cells of a half in a cube of edge 2, and those that reach in from outside.
    assert 64 <= len(np.unique(name)) <= 6**3


@pytest.mark.parametrize(
    "texture",
    [
        plain((0.5, 0.2, 0.1)),
        speckled((0.1, 0.1, 0.1), (0.9, 0.9, 0.9), 0.01, 0.4),
        scaly((0.1, 0.4, 0.1), (0.02, 0.05, 0.02), 0.01),
        streaked((0.8, 0.8, 0.7), (0.3, 0.3, 0.3), 0.002, 0.02),
        wood((0.4, 0.3, 0.1), (0.1, 0.06, 0.03), 0.1),
        woven((0.1, 0.2, 0.3), (0.6, 0.6, 0.5), 0.002),
        printed((0.8, 0.8, 0.7), (0.02, 0.02, 0.02), 0.006),
    ],
)
def test_textures_are_colours_and_smooth_out_with_distance(texture):
    near = texture(POINTS, np.full(len(POINTS), 1e-4))
    far = texture(POINTS, np.full(len(POINTS), 0.02))
    assert near.shape == (len(POINTS), 3)
    assert near.min() >= 0 and near.max() <= 1
    assert np.all(far.std(axis=0) < near.std(axis=0))
    np.testing.assert_allclose(far.mean(axis=0), near.mean(axis=0), atol=0.04)  # as bright from afar
