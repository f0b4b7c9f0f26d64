"""The zero-crossing correction against closed forms: a sphere whose field is biased."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import label

from threedfs.deform.bridges import keep_apart
from threedfs.deform.correction import CorrectionRule, correct_zero_crossing
from threedfs.deform.evidence import (
    SurfaceSamples,
    average_in_cells,
    check_samples,
    measure_scatter,
    sample_gradient,
    take_points,
)
from threedfs.deform.rbf import evaluate_at, evaluate_on_grid, place_basis
from threedfs.deform.ridge import fit_ridge
from threedfs.deform.samples import draw_anchors, draw_controls
from threedfs.errors import UserError
from threedfs.geometry.grid import cover_box, voxel_centres
from threedfs.geometry.plane import widest_gap
from threedfs.types import Box, OrientedPoints, Plane

GRID = cover_box(Box(np.eye(3), np.full(3, -0.5), np.full(3, 0.5)), 50)
CLIP = 6 * GRID.spacing
RADIUS = 0.3
SEEN = np.ones(GRID.shape, np.uint8)
RULE = CorrectionRule(
    rbf_width=0.12,
    controls=1500,
    control_level=0.5,
    surface_points=1000,
    anchors=300,
    ridge=1.0,
    reweightings=0,
    residual_scale=0.1,
)
FLOOR = Plane(np.array([0.0, 0, 1]), 0.5)


def biased_field(bias):
    """Field of a sphere whose surface lies too far out by `bias(direction)`."""
    offset = voxel_centres(GRID)
    distance = np.linalg.norm(offset, axis=-1)
    direction = offset / np.maximum(distance, 1e-9)[..., None]
    return np.clip((distance - RADIUS - bias(direction)) / CLIP, -1, 1).astype(np.float32)


def directions(count, seed=0):
    found = np.random.default_rng(seed).normal(size=(count, 3))
    return found / np.linalg.norm(found, axis=1, keepdims=True)


def sphere_points(count=1500, radius=RADIUS):
    normal = directions(count).astype(np.float32)
    pairs = np.repeat(np.arange(count), 4), np.tile(np.arange(4), count)
    return OrientedPoints(radius * normal, normal, np.zeros((count, 3), np.uint8), *pairs)


def take(points, sdf, **changed):
    settings = {"reach": 0.9, "min_cosine": 0.5, "full_sightings": 4, **changed}
    return take_points(points, sdf, SEEN, GRID, **settings)


def surface_error(sdf):
    """Distance of the zero level from the sphere along 200 rays, in voxels."""
    errors = []
    radii = np.linspace(0.5 * RADIUS, 1.4 * RADIUS, 400)
    from threedfs.deform.evidence import sample_field

    for direction in directions(200, seed=5):
        values = sample_field(sdf, GRID, radii[:, None] * direction)
        first = np.flatnonzero((values[:-1] < 0) & (values[1:] >= 0))[0]
        part = values[first] / (values[first] - values[first + 1])
        errors.append(radii[first] + part * (radii[1] - radii[0]) - RADIUS)
    return np.abs(errors) / GRID.spacing


@pytest.mark.parametrize(
    "bias",
    [lambda d: 1.5 * GRID.spacing + 0 * d[..., 0], lambda d: GRID.spacing * (1 + d[..., 0])],
    ids=["even", "tilted"],
)
def test_corrected_zero_level_of_a_biased_sphere_is_within_a_tenth_of_a_voxel(bias):
    """Exact: the bias is smooth, so the expansion can follow it."""
    sdf = biased_field(bias)
    assert surface_error(sdf).max() > 1
    corrected = correct_zero_crossing(sdf, SEEN, GRID, take(sphere_points(), sdf), RULE, np.random.default_rng(0))
    assert surface_error(corrected).max() < 0.1


def test_an_infinite_ridge_changes_nothing():
    sdf = biased_field(lambda d: GRID.spacing + 0 * d[..., 0])
    rule = replace(RULE, ridge=1e15)
    corrected = correct_zero_crossing(sdf, SEEN, GRID, take(sphere_points(), sdf), rule, np.random.default_rng(0))
    np.testing.assert_allclose(corrected, sdf, atol=1e-6)


def test_reweighting_forgives_points_off_the_surface():
    """Property: a fifth of the points two voxels outside moves the plain zero level, hardly the robust one."""
    sdf = biased_field(lambda d: 0 * d[..., 0])
    points = sphere_points()
    points.xyz[:300] *= 1 + 2 * GRID.spacing / RADIUS
    samples = take(points, sdf)
    plain = correct_zero_crossing(sdf, SEEN, GRID, samples, RULE, np.random.default_rng(0))
    robust = correct_zero_crossing(sdf, SEEN, GRID, samples, replace(RULE, reweightings=10), np.random.default_rng(0))
    assert np.median(surface_error(plain)) > 0.25
    assert np.median(surface_error(robust)) < 0.1


def test_voxels_that_no_view_sees_keep_their_value():
    sdf = biased_field(lambda d: GRID.spacing + 0 * d[..., 0])
    seen = SEEN.copy()
    seen[:25] = 0
    samples = take(sphere_points(), sdf)
    corrected = correct_zero_crossing(sdf, seen, GRID, samples, RULE, np.random.default_rng(0))
    np.testing.assert_array_equal(corrected[:25], sdf[:25])
    assert np.abs(corrected[25:] - sdf[25:]).max() > 0.1


def test_field_without_an_inner_level_is_corrected_too():
    """An object thinner than the clip distance never reaches -0.9."""
    sdf = np.maximum(biased_field(lambda d: GRID.spacing + 0 * d[..., 0]), -0.6)
    assert len(draw_anchors(sdf, SEEN, GRID, 300, np.random.default_rng(0))) == 300
    corrected = correct_zero_crossing(sdf, SEEN, GRID, take(sphere_points(), sdf), RULE, np.random.default_rng(0))
    assert surface_error(corrected).max() < 0.1


def test_same_seed_same_field():
    sdf = biased_field(lambda d: GRID.spacing + 0 * d[..., 0])
    samples = take(sphere_points(), sdf)
    first, second, other = (
        correct_zero_crossing(sdf, SEEN, GRID, samples, RULE, np.random.default_rng(seed)) for seed in (1, 1, 2)
    )
    np.testing.assert_array_equal(first, second)
    assert (first != other).any()


def test_points_against_the_field_are_left_out():
    sdf = biased_field(lambda d: 0 * d[..., 0])
    points = sphere_points(1000)
    points.normal[:100] *= -1
    points.xyz[100:300] *= 1.4
    outside = points.xyz.copy()
    outside[300:310] = 7
    points = replace(points, xyz=outside)
    assert len(take(points, sdf).xyz) == 690
    assert len(take(points, sdf, min_cosine=-1.0).xyz) == 790
    assert (take(points, sdf, min_cosine=-1.0).trust == 1).all()


def test_trust_grows_with_the_sightings():
    sdf = biased_field(lambda d: 0 * d[..., 0])
    few, many = take(sphere_points(), sdf, full_sightings=16), take(sphere_points(), sdf)
    np.testing.assert_allclose(few.trust, many.trust / 4)


def test_gradient_points_out_of_the_sphere():
    out = directions(50)
    gradient = sample_gradient(biased_field(lambda d: 0 * d[..., 0]), GRID, RADIUS * out)
    assert (gradient * out).sum(axis=1).min() > 0.99


def test_anchors_lie_on_both_levels_and_controls_on_both_sides():
    sdf = biased_field(lambda d: 0 * d[..., 0])
    anchors = draw_anchors(sdf, SEEN, GRID, 200, np.random.default_rng(0))
    distance = (np.linalg.norm(anchors, axis=1) - RADIUS) / CLIP
    np.testing.assert_allclose(distance[:200], 0.9, atol=0.051)
    np.testing.assert_allclose(distance[200:], -0.9, atol=0.051)
    controls = draw_controls(sdf, GRID, 1000, 0.5, np.random.default_rng(0))
    near = np.abs(np.linalg.norm(controls, axis=1) - RADIUS) < 0.5 * CLIP
    assert near.sum() == 500


def test_expansion_on_the_grid_is_the_sum_of_its_functions():
    """Oracle: the product of matrices against the direct sum, at random voxels."""
    rng = np.random.default_rng(0)
    centres, coefficients = rng.uniform(-0.5, 0.5, (300, 3)), rng.normal(size=300)
    field = evaluate_on_grid(GRID, centres, coefficients, 0.1)
    voxels = rng.integers(0, 50, (100, 3))
    places = voxel_centres(GRID)[tuple(voxels.T)]
    direct = [
        sum(a * np.exp(-((place - c) ** 2).sum() / 0.01) for a, c in zip(coefficients, centres, strict=True))
        for place in places
    ]
    np.testing.assert_allclose(field[tuple(voxels.T)], direct, atol=1e-5)
    np.testing.assert_allclose(evaluate_at(places, centres, 0.1) @ coefficients, direct, atol=1e-5)


@pytest.mark.parametrize(("count", "width"), [(3000, 0.02), (3000, 0.3), (40, 0.1)])
def test_groups_of_points_give_the_whole_sum(count, width):
    """Oracle: all functions at all points, against groups of points with the functions near them."""
    rng = np.random.default_rng(0)
    points, centres, coefficients = rng.random((count, 3)), rng.random((300, 3)), rng.normal(size=300)
    basis = place_basis(points, centres, width)
    assert np.array_equal(np.sort(np.concatenate([rows for rows, _ in basis.groups])), np.arange(count))
    if width == 0.02:
        assert max(len(columns) for _, columns in basis.groups) < 200
    whole = evaluate_at(points, centres, width)
    np.testing.assert_allclose(basis.combine(coefficients), whole @ coefficients, atol=1e-5)


@pytest.mark.parametrize("count", [60, 1500])
def test_ridge_solves_the_normal_equations(count):
    """Oracle: the normal equations of Eq. 18 in one piece, with fewer points than functions and with more."""
    rng = np.random.default_rng(0)
    points, centres = rng.random((count, 3)), rng.random((200, 3))
    target, weight = rng.normal(size=count), rng.uniform(0, 2, count)
    found = fit_ridge(place_basis(points, centres, 0.03), target, weight, 0.3)
    whole = evaluate_at(points, centres, 0.03)
    matrix = whole.T @ (weight[:, None] * whole) + 0.15 * np.eye(200)
    np.testing.assert_allclose(found, np.linalg.solve(matrix, whole.T @ (weight * target)), atol=1e-6)


def test_points_of_a_cell_become_their_mean_by_trust():
    """Exact: cells start at the lowest point, along every axis."""
    xyz = np.array([[-0.1, 0.2, 0.3], [0.1, 0.2, 0.5], [0.4, 0.2, 0.3], [-0.1, 0.8, 0.3], [-0.1, 0.2, 0.9]])
    samples = SurfaceSamples(xyz, np.array([0.2, 0.6, -0.1, 0.4, 0.3]), np.array([0.2, 0.6, 0.9, 0.3, 0.5]))
    cells = average_in_cells(samples, GRID, 0.5 / GRID.spacing)
    np.testing.assert_allclose(cells.xyz, [[0.05, 0.2, 0.45], xyz[4], xyz[3], xyz[2]])
    np.testing.assert_allclose(cells.sdf, [0.5, 0.3, 0.4, -0.1])
    np.testing.assert_allclose(cells.trust, np.array([0.8, 0.5, 0.3, 0.9]) / 0.625)


def test_points_that_err_on_their_own_average_out():
    """Property: as many drawn points as there are cells leave more of their noise in the zero level."""
    sdf = biased_field(lambda d: 0 * d[..., 0])
    points = sphere_points(20000)
    points.xyz[:] *= 1 + np.random.default_rng(3).normal(0, 0.3 * GRID.spacing / RADIUS, (20000, 1)).astype(np.float32)
    samples = take(points, sdf)
    cells = average_in_cells(samples, GRID, 1.5)
    rule = replace(RULE, surface_points=len(cells.xyz))
    drawn, averaged = (
        correct_zero_crossing(sdf, SEEN, GRID, some, rule, np.random.default_rng(0)) for some in (samples, cells)
    )
    assert np.median(surface_error(averaged)) < 0.5 * np.median(surface_error(drawn))


@pytest.mark.parametrize("bias", [0.0, 1.0])
def test_scatter_is_that_of_points_about_their_neighbours(bias):
    """Exact: the median of a normal error is 0.674 of its deviation, whatever bias the field has."""
    sdf = biased_field(lambda d: bias * GRID.spacing + 0 * d[..., 0])
    points = sphere_points(20000)
    points.xyz[:] *= 1 + np.random.default_rng(3).normal(0, 0.8 * GRID.spacing / RADIUS, (20000, 1)).astype(np.float32)
    assert measure_scatter(take(points, sdf), sdf, GRID) == pytest.approx(0.674 * 0.8, rel=0.1)
    few = take(sphere_points(60), sdf)
    assert measure_scatter(few, sdf, GRID) == 0


def test_scattered_points_move_the_zero_level_less_the_less_they_are_believed():
    """Property: points that err by a voxel each flatten the field where they are believed fully."""
    sdf = biased_field(lambda d: 0 * d[..., 0])
    points = sphere_points(20000)
    points.xyz[:] *= 1 + np.random.default_rng(3).normal(0, GRID.spacing / RADIUS, (20000, 1)).astype(np.float32)
    samples = take(points, sdf)
    rule = replace(RULE, surface_points=50000)
    error = []
    for belief in (1.0, 0.05):
        cells = average_in_cells(samples, GRID, 1.5, belief)
        corrected = correct_zero_crossing(sdf, SEEN, GRID, cells, rule, np.random.default_rng(0))
        error.append(np.median(surface_error(corrected)))
    assert error[1] < 0.5 * error[0]


def test_reweighting_forgives_dense_points_off_the_surface():
    """Property: a fifth of the points two voxels outside fill nearly as many cells as the others, but thinly."""
    sdf = biased_field(lambda d: 0 * d[..., 0])
    points = sphere_points(5000)
    points.xyz[:] *= 1 + np.random.default_rng(3).normal(0, 0.1 * GRID.spacing / RADIUS, (5000, 1)).astype(np.float32)
    points.xyz[:1000] *= 1 + 2 * GRID.spacing / RADIUS
    cells = average_in_cells(take(points, sdf), GRID, 1.5)
    rule = replace(RULE, surface_points=50000, reweightings=5)
    robust = correct_zero_crossing(sdf, SEEN, GRID, cells, rule, np.random.default_rng(0))
    assert np.median(surface_error(robust)) < 0.12


def test_widest_gap_is_found_around_the_axis():
    angles = np.radians([0, 90, 200])
    offsets = np.stack([np.cos(angles), np.sin(angles), [5, -2, 0]], axis=1)
    assert widest_gap(offsets, np.array([0.0, 0, 1])) == pytest.approx(160)


def samples_of(xyz):
    return SurfaceSamples(xyz, np.zeros(len(xyz)), np.ones(len(xyz)))


def test_too_few_points_are_refused():
    with pytest.raises(UserError, match="at least 50 surface points near the fused surface of the object, found 0"):
        check_samples(samples_of(np.zeros((0, 3))), np.zeros(3), FLOOR)


def test_points_on_one_side_are_refused():
    xyz = directions(2000)
    check_samples(samples_of(xyz), np.zeros(3), FLOOR)
    one_side = xyz[(xyz[:, 0] > 0) & (np.abs(xyz[:, 1]) < 0.5 * xyz[:, 0])]
    with pytest.raises(UserError, match="all of them within 53 degrees"):
        check_samples(samples_of(one_side), np.zeros(3), FLOOR)


def test_solids_stay_apart():
    """Exact: two slabs that grow into a gap of three voxels leave its middle open; one slab grows as it will."""
    before, above = np.ones((12, 4, 4), np.float32), np.ones((12, 4, 4), bool)
    before[:4], before[7:] = -1, -1
    grown = before.copy()
    grown[4:7] = -0.5
    apart = keep_apart(before, grown, above)
    labels, count = label(apart < 0)
    assert count == 2 and (apart[:4] < 0).all() and (apart[7:] < 0).all()
    assert set(np.unique(labels[4])) <= {0, 1} and ((apart[4:7] < 0).all(axis=(1, 2)).sum()) == 1
    below = above.copy()
    below[:6] = False  # where the first slab does not count, nothing is joined
    np.testing.assert_array_equal(keep_apart(before, grown, below), grown)


def test_a_lone_solid_grows_freely():
    sdf = biased_field(lambda d: -1.5 * GRID.spacing + 0 * d[..., 0])
    corrected = correct_zero_crossing(sdf, SEEN, GRID, take(sphere_points(), sdf), RULE, np.random.default_rng(0))
    np.testing.assert_array_equal(keep_apart(sdf, corrected, SEEN > 0), corrected)
