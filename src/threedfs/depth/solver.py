"""Dense depth of one keyframe by two-step optimisation: the whole of Section 3.2 on one screen."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from threedfs.depth.bending import release_bends
from threedfs.depth.halving import DepthData, double_depth, halve_data
from threedfs.depth.linear_solve import pose_problem, replace_prior, solve_surface
from threedfs.depth.search import cheapest_depth, search_depth
from threedfs.depth.weights import coupling_schedule, smoothness_at

_LEAST_SIDE = 64
"""Pixels; smaller images are not halved."""


@dataclass(frozen=True)
class DepthSolution:
    """Dense depth (H, W) float64, and for each iteration the linear solve's residual and steps."""

    depth: np.ndarray
    residuals: tuple[float, ...]
    steps: tuple[int, ...]


def optimise_depth(
    cost_volume: np.ndarray,
    candidates: np.ndarray,
    confidence: np.ndarray,
    measured_depth: np.ndarray,
    measurement_weight: np.ndarray,
    edge_weight: np.ndarray,
    *,
    prior: str,
    iterations: int,
    fine_iterations: int,
    photometric_weight: float,
    coupling: float,
    coupling_decay: float,
    coupling_reading: str = "product",
    median_size: int,
    newton_rate: float,
    smoothness: float,
    smoothness_growth: float,
    tolerance: float,
    early_tolerance: float,
    max_steps: int,
    break_bending: float,
    magnification: float = 1.0,
    note: Callable[[str], None] = lambda message: None,
) -> DepthSolution:
    """Minimise Eq. 2 by alternating Eqs. 5-7 and Eq. 8.

    Parameters
    ----------
    cost_volume : (D, H, W) float32
        Photometric error in [0, 1] (Eq. 1).
    candidates : (D,) float64
        Depths, ascending, scene units.
    confidence : (H, W) float64
        lambda_a, 0 where the image shows nothing.
    measured_depth, measurement_weight : (H, W) float64
        Semi-dense depths and lambda_m, weight 0 where there is none.
    edge_weight : (H, W) float64
        Spatial factor of lambda_s.
    magnification : float
        How many pixels lie along what is one pixel long where smoothness and break_bending hold.
    Others
        See `DepthParams`.

    Notes
    -----
    The search starts from the smoothest surface through the measurements and the most photo-consistent depths
    (a solve of Eq. 8 before the first iteration): the paper does not say from where.

    Differs from the paper: iterations before the last few put 2x2 pixels together. Sums over pixels then have a
    quarter of the terms and differences of second order are four times as large (of first order twice), so the
    smoothness weight is a sixteenth (a quarter) of what it is at full resolution. Where the object is larger in its
    image, `magnification` does the opposite, so that it is as smooth as in a small one.

    Also beyond the paper: from half of the iterations on, smoothing gives way where the surface bends sharply
    (`release_bends`), which keeps the background from being drawn towards the object around its silhouette.
    """
    schedule = coupling_schedule(coupling, coupling_decay, iterations, coupling_reading)
    fine = DepthData(cost_volume, confidence, measured_depth, measurement_weight, edge_weight)
    halved = fine_iterations < iterations and min(confidence.shape) >= _LEAST_SIDE
    data = halve_data(fine) if halved else fine
    problem = pose_problem(data.edge_weight, data.confidence, data.measurement_weight, prior)
    auxiliary_depth = cheapest_depth(data.cost_volume, candidates)
    depth = np.full(auxiliary_depth.shape, np.median(auxiliary_depth))
    residuals, steps = [], []
    for iteration in range(iterations + 1):
        if halved and iteration > iterations - fine_iterations:
            halved, data = False, fine
            depth = double_depth(depth, confidence.shape)
            problem = pose_problem(data.edge_weight, data.confidence, data.measurement_weight, prior)
        # Over twice the distance a bend of the surface is four times as large, a slope twice.
        growth = ((2 if halved else 1) / magnification) ** (1 if prior == "first_order" else 2)
        if break_bending > 0 and iteration > iterations // 2:
            kept = release_bends(depth, growth * break_bending, prior)
            problem = replace_prior(problem, data.edge_weight * kept, prior)
        if iteration:
            auxiliary_depth = search_depth(
                data.cost_volume,
                candidates,
                depth,
                photometric_weight=photometric_weight,
                coupling=schedule[iteration - 1],
                median_size=median_size,
                newton_rate=newton_rate,
            )
        solution = solve_surface(
            problem,
            auxiliary_depth,
            data.measured_depth,
            depth,
            coupling_factor=1 / (2 * schedule[max(iteration - 1, 0)]),
            smoothness=smoothness_at(max(iteration, 1), smoothness, smoothness_growth) / growth**2,
            tolerance=tolerance if iteration == iterations else early_tolerance,
            max_steps=max_steps,
        )
        depth = solution.depth
        residuals.append(solution.residual)
        steps.append(solution.steps)
        note(f"iteration {iteration}/{iterations}: {solution.steps} steps, residual {solution.residual:.1e}")
    return DepthSolution(depth, tuple(residuals), tuple(steps))
