"""Trust in depth: what confirms it and what does not."""

import numpy as np
import pytest

from threedfs.surface.trust import (
    TrustRule,
    rate_roundness,
    rate_sureness,
    share_matched,
    trust_aslant,
    trust_depth,
    trust_free,
)

RULE = TrustRule(
    agree_from=2.0,
    agree_full=5.0,
    matched=0.01,
    bare_matched=0.03,
    matched_reach=0.05,
    matched_from=0.1,
    matched_full=0.4,
    sure_from=0.5,
    sure_full=0.9,
    free_contradicted=0.15,
    free_from=0.4,
    free_full=0.6,
    free_textured=2.0,
    textured_from=0.6,
    textured_full=0.8,
    aslant_agree_from=5.0,
    aslant_agree_full=9.0,
    aslant_from=0.3,
    aslant_full=0.7,
    mirrored_height=0.05,
    hollow_agree=5.0,
    round_full=0.05,
    round_until=0.1,
)
SHAPE = (40, 60)
INSIDE = np.ones(SHAPE, bool)


def rate(agree, confidence=1.0, photometric=0.0, mask=INSIDE, reach=5.0, rule=RULE, sureness=0.0):
    maps = (np.full(SHAPE, value, kind) for value, kind in ((agree, np.uint8), (confidence, np.float32)))
    matched = share_matched(np.broadcast_to(np.float32(photometric), SHAPE), mask, reach, rule, sureness)
    return trust_depth(*maps, matched, rule)


@pytest.mark.parametrize(("agree", "trust"), [(0, 0.0), (2, 0.0), (3, 1 / 3), (5, 1.0), (9, 1.0)])
def test_many_views_confirm_a_bare_face(agree, trust):
    np.testing.assert_allclose(rate(agree), trust, atol=1e-6)


def test_agreement_of_the_few_that_speak_does_not_confirm_a_bare_face():
    assert rate(1, confidence=1.0, photometric=0.0).max() == 0


def test_where_photographs_match_few_views_are_believed_as_far_as_none_contradicts():
    np.testing.assert_allclose(rate(1, confidence=0.7, photometric=0.5), 0.7, atol=1e-6)


def test_a_pixel_is_helped_by_matches_around_it_on_the_object_alone():
    photometric = np.zeros(SHAPE, np.float32)
    photometric[:, :30] = 0.5
    beside = rate(1, photometric=photometric)
    assert beside[20, 32] > 0.5 > beside[20, 55] == 0
    table = np.zeros(SHAPE, bool)
    table[:, 30:] = True
    assert rate(1, photometric=photometric, mask=table)[20, 32] == 0


def test_a_wider_neighbourhood_reaches_farther():
    photometric = np.zeros(SHAPE, np.float32)
    photometric[:, :30] = 0.5
    near, far = (rate(1, photometric=photometric, reach=reach)[20, 42] for reach in (3.0, 15.0))
    assert near == 0 < far


def test_sureness_rises_with_the_mean_trust_in_the_masks():
    """Exact: half way between the two ends; what no mask holds does not count, nor do empty masks."""
    left, none = np.zeros((4, 6), bool), np.zeros((4, 6), bool)
    left[:, :3] = True
    trust = np.where(left, 0.7, 0.0).astype(np.float32)
    assert rate_sureness([trust, trust], [left, none], RULE) == pytest.approx(0.5, abs=1e-6)
    assert rate_sureness([trust], [~none], RULE) == 0
    assert rate_sureness([np.ones((4, 6), np.float32)], [left], RULE) == 1


def test_on_a_bare_object_matches_must_be_better():
    """Exact: a match half way between the two, 0.015, counts from a sureness of 0.75 on."""
    bare, sure = (rate(1, photometric=0.015, rule=RULE, sureness=sureness).max() for sureness in (0.0, 0.8))
    assert bare == 0 < sure
    assert rate(1, photometric=0.015, sureness=0.7).max() == 0


def test_depth_that_many_views_agree_on_is_trusted_though_the_surface_turns_away():
    """Exact: times the cosine, half way up either ramp it is a half, at the end of both full, at 0.3 as before."""
    agree, cosine = np.uint8([5, 7, 9, 20, 20, 20]), np.array([0.8, 0.8, 0.8, 0.7, 0.5, 0.3])
    trust = np.float32([0.4, 0.4, 1.0, 0.0, 0.4, 0.4])
    believed = trust_aslant(trust, agree, cosine, RULE)
    np.testing.assert_allclose(believed * cosine, [0.32, 0.5, 1.0, 1.0, 0.5, 0.12], atol=1e-6)


def test_space_that_few_contradict_is_free_however_few_agree():
    """Exact: of 20 keyframes fewer than three may have a surface there; elsewhere the trust in the depth decides."""
    own, too_far = np.float32([0.0, 0.2, 0.2, 0.9]), np.uint8([0, 2, 3, 20])
    free = trust_free(own, too_far, np.full(4, 0.6), 20, 1.0, RULE)
    np.testing.assert_array_equal(free, np.float32([1, 1, 0.2, 0.9]))


def test_more_may_contradict_where_nearly_all_photographs_match():
    """Exact: twice as many where 0.8 match, half as many more at 0.7."""
    own, too_far = np.full(4, 0.2, np.float32), np.uint8([4, 5, 5, 6])
    free = trust_free(own, too_far, np.array([0.7, 0.7, 0.8, 0.8]), 20, 1.0, RULE)
    np.testing.assert_array_equal(free, np.float32([1, 0.2, 1, 0.2]))


@pytest.mark.parametrize(("sureness", "matched", "believed"), [(1.0, 0.5, 0.5), (0.4, 0.6, 0.5), (0.2, 1.0, 0.0)])
def test_space_is_no_freer_than_depth_is_trusted_on_bare_faces_and_objects(sureness, matched, believed):
    """Exact: half way up either ramp it is believed by half, and never less than the depth is trusted."""
    own, none = np.float32([0.0, 0.7]), np.zeros(2, np.uint8)
    free = trust_free(own, none, np.full(2, matched), 20, sureness, RULE)
    np.testing.assert_allclose(free, np.maximum(own, np.float32(believed)), atol=1e-6)


@pytest.mark.parametrize(
    ("agreed", "deep", "sureness", "roundness"),
    [
        (0, 100, 0.0, 1.0),
        (5, 100, 0.0, 1.0),
        (8, 100, 0.0, 0.4),
        (10, 100, 0.0, 0.0),
        (0, 100, 0.7, 0.3),
        (0, 0, 0.0, 1.0),
    ],
)
def test_a_bare_object_is_round_where_views_agree_on_hardly_any_depth_inside(agreed, deep, sureness, roundness):
    """Exact: between the two shares in proportion; the surer the depth, the less."""
    assert rate_roundness(agreed, deep, sureness, RULE) == pytest.approx(roundness)


@pytest.mark.parametrize(("agree", "trust"), [(0, 0.25), (3, 1 / 3), (9, 1.0)])
def test_what_few_views_see_of_a_round_object_is_trusted_less(agree, trust):
    """Exact: what no view contradicts counts a quarter, what views agree on as ever."""
    counts, full = np.full(SHAPE, agree, np.uint8), np.ones(SHAPE)
    np.testing.assert_allclose(trust_depth(counts, full, full, RULE, hollows=0.25), trust, rtol=1e-6)
