"""Scores of contours on copies of a truth whose distance from it is known."""

from __future__ import annotations

import numpy as np
import pytest

from threedfs.evaluate.contours import ContourCounts, count_matches, match_contours, score_contours

SHAPE = (120, 160)  # diagonal 200, so the tolerance is 1.5 pixels


def frame(shift=0):
    """The outline of a rectangle, moved to the right."""
    truth = np.zeros(SHAPE, bool)
    truth[30, 40 + shift : 101 + shift] = truth[90, 40 + shift : 101 + shift] = True
    truth[30:91, 40 + shift] = truth[30:91, 100 + shift] = True
    return truth


def f_measure(found, truths):
    return score_contours([count_matches(found.astype(float), truths, [0.5])], [0.5]).ods


def test_a_copy_within_the_tolerance_is_perfect():
    """Exact: 0 and 1 pixels are within 1.5."""
    assert f_measure(frame(), [frame()]) == 1
    assert f_measure(frame(1), [frame()]) == 1


def test_a_copy_beyond_the_tolerance_matches_nothing_of_a_line():
    """Exact: a vertical line moved by 2 pixels is no match."""
    one, other = np.zeros(SHAPE, bool), np.zeros(SHAPE, bool)
    one[20:100, 50], other[20:100, 52] = True, True
    assert f_measure(one, [other]) == 0


def test_matches_are_one_to_one():
    """Exact: two lines beside one match as many pixels as it has."""
    thick, single = np.zeros(SHAPE, bool), np.zeros(SHAPE, bool)
    thick[20:100, 50:52], single[20:100, 50] = True, True
    of_thick, of_single = match_contours(thick, single, 1.5)
    assert of_thick.sum() == of_single.sum() == 80
    assert f_measure(thick, [single]) == pytest.approx(2 / 3)


def test_the_matching_is_the_largest():
    """Exact: a greedy match of the middle pixel would leave one of the ends without a partner."""
    first, second = np.zeros((5, 9), bool), np.zeros((5, 9), bool)
    first[2, [2, 4]], second[2, [3, 5]] = True, True
    assert match_contours(first, second, 1.0)[0].sum() == 2


def test_precision_asks_any_annotator_and_recall_all():
    """Exact: of two annotators one sees nothing of the contour; by the benchmark that costs recall alone."""
    other = np.zeros(SHAPE, bool)
    other[5, 10:20] = True
    counts = count_matches(frame().astype(float), [frame(), other], [0.5])
    assert counts.right[0] == counts.found[0] == frame().sum()
    assert counts.recalled[0] == frame().sum() and counts.wanted[0] == frame().sum() + 10


def test_ois_takes_the_best_threshold_of_each_image():
    """Exact: two images with different best thresholds; no single one is perfect for both."""
    low = ContourCounts(*(np.array(row) for row in ([10, 0], [10, 0], [10, 10], [10, 0])))
    high = ContourCounts(*(np.array(row) for row in ([20, 10], [10, 10], [10, 10], [10, 10])))
    found = score_contours([low, high], [0.2, 0.8])
    assert found.ois == 1
    assert found.threshold == 0.2
    assert found.ods == pytest.approx(2 * (20 / 30) / (20 / 30 + 1))


def test_empty_contours_score_zero():
    """Exact: nothing found, or nothing to find, is no division by zero."""
    nothing = np.zeros(SHAPE, bool)
    assert f_measure(nothing, [frame()]) == 0
    assert f_measure(frame(), [nothing]) == 0
