"""The contour detector: trained in little on painted pictures, and as the package carries it."""

from __future__ import annotations

import hashlib
from dataclasses import replace

import numba
import numpy as np
import pytest

from threedfs.edges.forest import FEATURES, Forest, feature_table
from threedfs.edges.structured import list_contours, structured_contours
from threedfs.edges.thin import thin
from threedfs.edges.training.grow import Growth, join_trees
from threedfs.edges.training.leaves import paint_leaves
from threedfs.edges.training.patterns import TILE, make_tiles
from threedfs.edges.training.picture import Picture, contour_pixels, cut_label, link_segments
from threedfs.edges.training.samples import draw_samples
from threedfs.edges.training.train import Plan, train_forest
from threedfs.errors import UserError
from threedfs.io.contour_forest import CARRIED, SHA256, read_forest, write_forest


@pytest.fixture(scope="module")
def pictures():
    """Six pictures of discs on plain ground, of random colours."""
    found = []
    for index in range(6):
        rng = np.random.default_rng(index)
        v, u = np.mgrid[:96, :128]
        segments = (np.hypot(v - rng.uniform(30, 66), u - rng.uniform(40, 88)) < rng.uniform(15, 30)).astype(int)
        colours = np.array([[40, 60, 50], [180, 150, 160]])[:: 1 if index % 2 else -1]
        image = np.clip(colours[segments] + rng.normal(0, 6, (96, 128, 3)), 0, 255).astype(np.uint8)
        found.append(Picture(image, *link_segments(segments)))
    return found


@pytest.fixture(scope="module")
def plan():
    return Plan(windows=60, trees=2, feature_share=0.1, growth=Growth(pairs=64), seed=5)


@pytest.fixture(scope="module")
def small(pictures, plan):
    return train_forest(plan, pictures, lambda items, _: items)


def everywhere(image):
    return np.ones(image.shape[:2], bool)


def halves(left, right):
    image = np.empty((80, 100, 3), np.uint8)
    image[:, :50], image[:, 50:] = left, right
    return image


def test_a_small_forest_finds_the_contours_it_was_shown(small, pictures):
    """Property: strength on contours exceeds that farther than a label from them several times."""
    picture = pictures[0]
    strength = structured_contours(picture.image, everywhere(picture.image), small, (1.0,))
    contour = contour_pixels(picture)
    far = np.ones_like(contour)
    for row, column in np.argwhere(contour):
        far[max(row - 8, 0) : row + 9, max(column - 8, 0) : column + 9] = False
    assert strength.dtype == np.float32 and 0 <= strength.min() and strength.max() <= 1
    assert strength[contour].mean() > 0.1
    assert strength[contour].mean() > 10 * strength[far].mean()


def test_the_same_seed_gives_the_same_bytes(small, pictures, plan, tmp_path):
    """Exact: trained again the file is the same, with another seed it is not."""
    digest = write_forest(tmp_path / "a.npz", small)
    again = train_forest(plan, pictures, lambda items, _: items)
    other = train_forest(replace(plan, seed=6), pictures, lambda items, _: items)
    assert write_forest(tmp_path / "b.npz", again) == digest
    assert write_forest(tmp_path / "c.npz", other) != digest


def test_a_forest_survives_its_file(small, tmp_path):
    """Exact: half precision loses nothing of the thresholds."""
    digest = write_forest(tmp_path / "a.npz", small)
    read = read_forest(tmp_path / "a.npz", digest)
    for name in ("roots", "feature", "threshold", "child", "labels"):
        np.testing.assert_array_equal(getattr(read, name), getattr(small, name))
        assert getattr(read, name).dtype == getattr(small, name).dtype


def test_another_file_is_refused(small, tmp_path):
    write_forest(tmp_path / "a.npz", small)
    with pytest.raises(UserError, match="expected the forest with SHA-256 0000"):
        read_forest(tmp_path / "a.npz", "0000")
    with pytest.raises(UserError, match="found none"):
        read_forest(tmp_path / "b.npz", "0000")


def test_the_forest_carried_is_the_one_its_reader_names():
    """Exact: below 8 MB, with the checksum that enters the identity of the stage's code."""
    content = CARRIED.read_bytes()
    assert len(content) < 8e6
    assert hashlib.sha256(content).hexdigest() == SHA256


@pytest.fixture(scope="module")
def forest():
    return read_forest()


def test_nodes_of_the_forest_lead_on(forest):
    """Exact: children come after their parents, leaves name labels, features exist."""
    inner = forest.feature >= 0
    assert np.all(forest.child[inner] > np.flatnonzero(inner))
    assert forest.child[inner].max() + 1 < len(forest.feature)
    assert np.array_equal(np.sort(forest.child[~inner]), np.arange(len(forest.labels)))
    assert forest.feature.max() < FEATURES == len(feature_table())


def test_a_step_is_found_where_it_is(forest):
    """Property: the ridge of a step between columns 49 and 50 lies on one of them; a blank image has next to none."""
    image = halves((200, 40, 40), (40, 60, 190))
    strength = structured_contours(image, everywhere(image), forest)
    middle = strength[20:60]
    assert np.all(np.isin(middle.argmax(axis=1), (49, 50)))
    assert middle.max(axis=1).min() > 0.2
    assert middle[:, :36].max() < 0.1 * middle.max()
    blank = halves((120, 120, 120), (120, 120, 120))
    assert structured_contours(blank, everywhere(blank), forest).max() < 0.05


def test_texture_is_looked_over(forest):
    """Property: stripes of the contrast of a contour are weaker than it."""
    image = halves((70, 70, 70), (180, 180, 180))
    image[:, 10:40:4] += 60
    image[:, 11:40:4] += 60
    strength = structured_contours(image, everywhere(image), forest)[15:65]
    assert strength[:, 49:51].max(axis=1).mean() > 2 * strength[:, 16:36].mean()


def test_the_border_of_the_valid_image_is_no_contour(forest):
    """Exact: what lies outside changes nothing, and there is no strength there or at its border."""
    image, valid = halves((200, 40, 40), (40, 60, 190)), np.zeros((80, 100), bool)
    valid[10:-8, 12:-12] = True
    black, white = image.copy(), image.copy()
    black[~valid], white[~valid] = 0, 255
    strength = structured_contours(black, valid, forest)
    np.testing.assert_array_equal(strength, structured_contours(white, valid, forest))
    assert not strength[~valid].any() and not strength[10, 12:-12].any()
    assert strength[12:-10, 14:40].max() < 0.1 * strength.max()
    assert not structured_contours(image, np.zeros_like(valid), forest).any()


@pytest.mark.parametrize("shape", [(61, 83), (3, 5), (40, 17)])
def test_any_size_of_image_is_taken(forest, shape):
    image = np.random.default_rng(0).integers(0, 256, (*shape, 3), dtype=np.uint8)
    strength = structured_contours(image, everywhere(image), forest)
    assert strength.shape == shape and np.isfinite(strength).all()


def test_threads_change_no_byte(forest):
    image = np.random.default_rng(1).integers(0, 256, (60, 80, 3), dtype=np.uint8)
    before = numba.get_num_threads()
    results = []
    try:
        for threads in (1, min(2, numba.config.NUMBA_NUM_THREADS)):
            numba.set_num_threads(threads)
            results.append(structured_contours(image, everywhere(image), forest).tobytes())
    finally:
        numba.set_num_threads(before)
    assert results[0] == results[1]


def test_thinning_leaves_one_pixel_across():
    """Exact: the ridge of a Gaussian along a column is that column."""
    across = np.exp(-(((np.arange(60) - 30) / 2.0) ** 2)).astype(np.float32)
    thinned = thin(np.tile(across, (40, 1)))
    assert np.array_equal(np.flatnonzero(thinned[20] > 0.05), [30])


def test_labels_are_the_connected_pieces_of_a_patch():
    """Exact: a line across separates, a line that ends inside does not."""
    segments = np.zeros((16, 16), int)
    segments[:, 6:] = 1
    right, down = link_segments(segments)
    label = np.empty((16, 16), np.uint8)
    assert cut_label(right, down, 0, 0, label) == 2
    np.testing.assert_array_equal(label, segments)
    right[8:, 5] = True
    assert cut_label(right, down, 0, 0, label) == 1 and not label.any()


def test_contours_of_labels_lie_on_both_sides():
    label = np.zeros((1, 16, 16), np.uint8)
    label[0, :, 6:] = 1
    patch, row, column = list_contours(label)
    assert set(patch) == {0} and set(row) == set(range(16)) and set(column) == {5, 6}


def test_painted_pictures_follow_from_their_seed():
    """Exact: same seed same picture; tiles have mean 0 and deviation 1; there are contours."""
    tiles = make_tiles(2, np.random.default_rng(0))
    assert tiles[0].shape == (TILE, TILE, 3)
    assert abs(tiles[0].mean()) < 1e-3 and abs(tiles[0].std() - 1) < 0.05
    one, other = (paint_leaves(60, 80, tiles, np.random.default_rng(3)) for _ in range(2))
    np.testing.assert_array_equal(one.image, other.image)
    assert one.image.shape == (60, 80, 3) and 0 < contour_pixels(one).mean() < 0.5


def test_samples_are_half_contours(pictures):
    """Property: of the labels about half have more than one segment, and bins ascend with their edges."""
    samples = draw_samples(pictures, 40, 0.02, np.random.default_rng(0))
    share = (samples.labels.reshape(len(samples.labels), -1).max(axis=1) > 0).mean()
    assert 0.4 < share < 0.7
    assert np.all(np.diff(samples.edges, axis=1) >= 0)
    assert samples.bins.max() <= 63


def test_joined_trees_are_walked_apart():
    """Exact: of two trees of one leaf each, neighbouring windows see one each, and votes halve."""
    labels = np.zeros((2, 16, 16), np.uint8)
    labels[0, :, 8:] = 1
    leaf = [
        Forest(np.zeros(1, np.int32), np.array([-1], np.int32), np.zeros(1, np.float32), np.zeros(1, np.int32), label)
        for label in (labels[:1], labels[1:])
    ]
    image = np.zeros((48, 48, 3), np.uint8)
    both = structured_contours(image, everywhere(image), join_trees(leaf), (1.0,))
    one = structured_contours(image, everywhere(image), leaf[0], (1.0,))
    np.testing.assert_allclose(both.mean(), one.mean() / 2, rtol=0.1)
