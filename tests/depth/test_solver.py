"""Regression and property: depth of a slanted plane, and a part of it without texture."""

import numpy as np
import pytest
import scenes

from threedfs.depth.bending import PRIORS
from threedfs.depth.candidates import space_candidates
from threedfs.depth.cost_volume import compute_cost_volume
from threedfs.depth.solver import optimise_depth
from threedfs.depth.weights import photometric_confidence, texture_confidence
from threedfs.depth.zncc import describe_patches

SETTINGS = dict(
    prior="rotation_invariant",
    iterations=12,
    fine_iterations=1,
    photometric_weight=100.0,
    coupling=1.0,
    coupling_decay=0.06,
    median_size=3,
    newton_rate=1.0,
    smoothness=1.0,
    smoothness_growth=1.8,
    tolerance=1e-6,
    early_tolerance=1e-4,
    max_steps=100,
    break_bending=0.003,
)


@pytest.fixture(scope="module")
def inputs():
    reference, *neighbours = scenes.views()
    images = scenes.grey_images(blank=True)
    candidates = space_candidates(0.6, 1.8, 32, "inverse")
    cost = compute_cost_volume(
        reference,
        images["0"],
        neighbours,
        lambda view: images[view.name],
        candidates,
        patch_radius=1,
        variance_floor=1.0,
        missing_cost=0.5,
    )
    confidence = photometric_confidence(cost.min(0).astype(float), 20.0)
    confidence *= texture_confidence(describe_patches(images["0"], 1, 1.0).variance, 10.0)
    nothing = np.zeros(cost.shape[1:])
    return cost, candidates, confidence, nothing, nothing, np.ones(cost.shape[1:]), scenes.plane_depth(reference)


def relative_error(inputs, **changes):
    *arguments, truth = inputs
    solution = optimise_depth(*arguments, **{**SETTINGS, **changes})
    # The outer pixels are seen by half of the neighbours only.
    return np.abs(solution.depth / truth - 1)[12:-12, 12:-12], solution


def test_plane_is_found_across_its_blank_part(inputs):
    """Candidates are 2 to 5 % apart: a median of 0.2 % shows that the sub-candidate steps and the prior work."""
    error, solution = relative_error(inputs)
    assert np.median(error) < 0.002 and np.percentile(error, 95) < 0.02
    assert solution.residuals[-1] <= 1e-6 and max(solution.residuals) <= 1e-4


def test_second_order_priors_beat_the_first_on_a_slanted_blank_part(inputs):
    errors = {prior: np.percentile(relative_error(inputs, prior=prior)[0], 95) for prior in PRIORS}
    assert errors["rotation_invariant"] < errors["first_order"]
    assert errors["second_order"] < errors["first_order"]


@pytest.mark.parametrize(
    "change",
    [
        {"iterations": 4},
        {"fine_iterations": 12},
        {"photometric_weight": 1.0},
        {"coupling": 0.01},
        {"coupling_decay": 0.01},
        {"median_size": 1},
        {"newton_rate": 0.0},
        {"smoothness": 0.01},
        {"smoothness_growth": 1.1},
        {"break_bending": 0.0},
        {"magnification": 2.0},
    ],
)
def test_every_parameter_acts(inputs, change):
    plain = relative_error(inputs)[1].depth
    assert np.abs(relative_error(inputs, **change)[1].depth - plain).max() > 1e-4


@pytest.mark.parametrize(("prior", "order"), [("first_order", 1), ("rotation_invariant", 2)])
def test_magnification_smooths_over_as_many_times_more_pixels(inputs, prior, order):
    """Over m pixels in place of one a difference of an order is m^order times as large, and is squared by the prior."""
    smoothness, bending = SETTINGS["smoothness"], SETTINGS["break_bending"]
    magnified = relative_error(inputs, prior=prior, magnification=2.0)[1].depth
    changed = {"smoothness": smoothness * 4**order, "break_bending": bending / 2**order}
    np.testing.assert_allclose(magnified, relative_error(inputs, prior=prior, **changed)[1].depth, rtol=1e-9)


def test_measurements_pull_the_blank_part(inputs):
    cost, candidates, confidence, _, _, edges, truth = inputs
    weight = np.zeros(truth.shape)
    weight[34:38, 46:50] = 1e4
    solution = optimise_depth(cost, candidates, confidence, 1.05 * truth, weight, edges, **SETTINGS)
    assert np.allclose(solution.depth[36, 48], 1.05 * truth[36, 48], rtol=5e-3)
