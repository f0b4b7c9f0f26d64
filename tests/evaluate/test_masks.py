"""Exact, oracle (scikit-learn) and rejection: intersection over union of shapes whose areas are known."""

import numpy as np
import pytest
from sklearn.metrics import jaccard_score

from threedfs.errors import UserError
from threedfs.evaluate.masks import check_mask_size, intersection_over_union


def square(left, side=10, shape=(30, 40)):
    mask = np.zeros(shape, bool)
    mask[5 : 5 + side, left : left + side] = True
    return mask


@pytest.mark.parametrize("shift", range(0, 12))
def test_shifted_squares(shift):
    overlap = max(10 - shift, 0) * 10
    assert intersection_over_union(square(3), square(3 + shift)) == overlap / (200 - overlap)


def test_is_symmetric_and_one_only_for_equal_masks():
    small, large = square(4, 8), square(4, 9)
    assert intersection_over_union(small, large) == intersection_over_union(large, small) == 64 / 81
    assert intersection_over_union(large, large) == 1


def test_empty_masks_agree_with_each_other_only():
    empty = np.zeros((30, 40), bool)
    assert intersection_over_union(empty, empty) == 1
    assert intersection_over_union(empty, square(0)) == 0


def test_refuses_a_mask_of_another_size():
    with pytest.raises(UserError, match=r"000010.png: expected a mask of 40 x 30 pixels .* got 30 x 40"):
        intersection_over_union(square(0), square(0).T, "masks/000010.png")
    with pytest.raises(UserError, match="like the source frames"):
        check_mask_size(square(0), (60, 80), "a.png")


@pytest.mark.parametrize("share", [0.01, 0.3, 0.9])
def test_against_scikit_learn(share):
    generator = np.random.default_rng(4)
    mask, truth = generator.random((2, 30, 40)) < share
    expected = jaccard_score(truth.ravel(), mask.ravel())
    assert intersection_over_union(mask, truth) == pytest.approx(expected, rel=1e-12)
