"""Exact and property tests of the check of depth maps against each other."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from threedfs.fusion.consistency import ComparisonRule, check_consistency, rate_confidence
from threedfs.fusion.softmax import SoftMaximum
from threedfs.geometry.grid import cover_box, voxel_centres
from threedfs.types import Box

RULE = ComparisonRule(tolerance=0.02, max_views=32, witness_share=0.5)


def rate(agreement):
    return rate_confidence(agreement, np.full(agreement.agree.shape, 0.8), prior_views=0.25, full_share=0.75)


@pytest.fixture(scope="module")
def exact(table):
    return [table.depth(view) for view in table.views]


def check(table, depths, **changes):
    return list(check_consistency(table.views, lambda rank: depths[rank], replace(RULE, **changes)))


def test_exact_depth_is_never_contradicted(table, exact):
    """Exact: true surfaces are seen, or hidden, but for pixels on silhouettes."""
    for agreement in check(table, exact):
        assert (agreement.too_near == 0).all()
        assert (agreement.too_far > 0).mean() < 0.02  # a rim one pixel wide
        assert np.median(agreement.agree) >= 3
        assert (rate(agreement) == 1).mean() > 0.97


@pytest.mark.parametrize(("factor", "verdict"), [(1.2, "too_far"), (0.8, "too_near")])
def test_wrong_view_is_found_out_and_the_others_stand(table, exact, factor, verdict):
    """Property: one map scaled by a fifth is contradicted in its direction and loses trust, the others keep theirs."""
    depths = [depth * (factor if rank == 3 else 1) for rank, depth in enumerate(exact)]
    agreements = check(table, depths)
    seen_by_others = agreements[3].agree + agreements[3].too_near + agreements[3].too_far > 0
    assert (getattr(agreements[3], verdict)[seen_by_others] > 0).mean() > 0.9
    assert np.median(rate(agreements[3])[seen_by_others]) < 0.3
    assert all((rate(agreement) > 0.9).mean() > 0.9 for rank, agreement in enumerate(agreements) if rank != 3)


def test_free_depth_ends_before_the_surface_looked_through(table, exact):
    """Exact: where the wrong map looks through the sphere, the ray is free up to the true surface."""
    depths = [depth * (1.2 if rank == 3 else 1) for rank, depth in enumerate(exact)]
    free = check(table, depths)[3].free_depth
    crossed = np.isfinite(free)
    assert crossed.mean() > 0.9
    assert (free[crossed] <= exact[3][crossed]).mean() > 0.97
    # Surfaces are drawn pixel by pixel and the nearest of 3x3 counts: some lie a few hundredths in front.
    assert np.median(free[crossed] / exact[3][crossed]) == pytest.approx(1 - RULE.tolerance, abs=0.02)


def test_depth_without_ground_speaks_against_no_one(table, exact):
    """Property: views whose depth no other confirms cannot take the trust from those that agree."""
    rng = np.random.default_rng(0)
    noise = [gaussian_filter(rng.normal(size=depth.shape), 8) for depth in exact]
    depths = [
        depth if rank % 2 else depth * np.exp(0.2 * wave / wave.std())
        for rank, (depth, wave) in enumerate(zip(exact, noise, strict=True))
    ]
    trust = [np.mean(rate(agreement)) for agreement in check(table, depths)]
    assert min(trust[1::2]) > 0.8
    assert max(trust[::2]) < 0.75  # pixels that no other view sees keep theirs


def test_one_wrong_view_does_not_carve(table, exact):
    """Oracle: with one map too far by a fifth the plain soft maximum loses the sphere, the weighted one keeps it."""
    depths = [depth * (1.2 if rank == 3 else 1) for rank, depth in enumerate(exact)]
    agreements = check(table, depths)
    grid = cover_box(Box(np.eye(3), np.array([-0.35, -0.35, 0.05]), np.array([0.35, 0.35, 0.6])), 50)
    inside = np.linalg.norm(voxel_centres(grid) - table.centre, axis=-1) < table.radius

    def overlap(weighted):
        fused = SoftMaximum(grid, 4 * grid.spacing, 10.0, distrust=40.0, discontinuity=0.02)
        for view, depth, agreement in zip(table.views, depths, agreements, strict=True):
            fused.add(view, depth, *((rate(agreement), agreement.free_depth) if weighted else ()))
        solid = fused.result()[0] < 0
        return (solid & inside).sum() / (solid | inside).sum()

    assert overlap(weighted=False) < 0.6
    assert overlap(weighted=True) > 0.85  # the rim of one voxel that a maximum loses is a tenth of the sphere


def test_missing_depth_says_nothing(table, exact):
    """Exact: NaN neither agrees nor contradicts, from either side."""
    blank = [depth if rank == 0 else np.full_like(depth, np.nan) for rank, depth in enumerate(exact)]
    agreements = check(table, blank)
    for agreement in agreements:
        assert not (agreement.agree | agreement.too_near | agreement.too_far).any()
        assert np.isinf(agreement.free_depth).all()


def test_compares_with_at_most_so_many_views(table, exact):
    """Exact."""
    for agreement in check(table, exact, max_views=2):
        assert (agreement.agree + agreement.too_near + agreement.too_far).max() <= 2


def test_few_maps_are_held(table, exact):
    """Property: each map is read once a block and pass, not kept."""
    read = []
    list(check_consistency(table.views, lambda rank: read.append(rank) or exact[rank], RULE))
    blocks = -(-len(table.views) // 8)
    assert len(read) == 2 * (len(table.views) + blocks * len(table.views))
