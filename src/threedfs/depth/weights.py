"""The spatially varying weights of the depth optimisation (Section 3.2, Eqs. 9-12)."""

from __future__ import annotations

import numpy as np

from threedfs.errors import UserError


def measurement_weight(variance: np.ndarray, proportionality: float) -> np.ndarray:
    """Weigh measurements by the inverse of their inverse-depth variance (item i); 0 where variance is NaN."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(np.isfinite(variance), proportionality / variance, 0.0)


def edge_weight(edge_strength: np.ndarray, edge_falloff: float) -> np.ndarray:
    """Weaken smoothing across image edges: the spatial factor of Eq. 9."""
    return np.exp(-edge_falloff * edge_strength)


def smoothness_at(iteration: int, initial: float, growth: float) -> float:
    """Grow the smoothness weight with the iterations, counted from 1: the other factor of Eq. 9."""
    return initial * growth ** (iteration - 1)


def coupling_schedule(initial: float, decay: float, iterations: int, reading: str = "product") -> np.ndarray:
    """Return the coupling theta after each of the iterations 1 .. n (Eq. 10), (n,) float64, positive.

    Parameters
    ----------
    initial, decay : float
        theta^(0) and beta.
    iterations : int
    reading : {"product", "linear"}
        ``product`` is Eq. 10 as printed, each theta 1 - decay t times the one before; ``linear`` is 1 - decay t times
        the first one.

    Raises
    ------
    UserError
        If the schedule reaches zero within the iterations: the factor 1 - decay t must stay positive.

    Examples
    --------
    >>> coupling_schedule(1.0, 0.1, 3).round(3)
    array([0.9  , 0.72 , 0.504])
    >>> coupling_schedule(1.0, 0.1, 3, "linear").round(3)
    array([0.9, 0.8, 0.7])
    """
    if decay * iterations >= 1:
        raise UserError(
            f"depth: expected decay * iterations < 1 so that the coupling of Eq. 10 stays positive, got "
            f"{decay} * {iterations} = {decay * iterations:.3g}; lower depth.coupling_decay or depth.iterations."
        )
    factors = 1 - decay * np.arange(1, iterations + 1)
    return initial * (factors if reading == "linear" else np.cumprod(factors))


def photometric_confidence(min_cost: np.ndarray, falloff: float) -> np.ndarray:
    """Trust a pixel's photometric depth the less, the larger its least error is (Eqs. 11 and 12)."""
    return np.exp(-falloff * min_cost)


def texture_confidence(variance: np.ndarray, half_variance: float) -> np.ndarray:
    """Trust a pixel by the texture of its patch: variance / (variance + half_variance), in grey levels squared.

    Beyond the paper: the least error over many candidates is low by chance where there is little texture.
    """
    if half_variance == 0:
        return np.ones_like(variance)
    return variance / (variance + half_variance)
