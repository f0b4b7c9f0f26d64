"""Zero-crossing correction: the field is bent until its zero level passes through surface points (Section 3.3.2)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from threedfs.deform.evidence import SurfaceSamples
from threedfs.deform.rbf import evaluate_on_grid, place_basis
from threedfs.deform.ridge import fit_ridge
from threedfs.deform.samples import draw_anchors, draw_controls
from threedfs.types import VoxelGrid


@dataclass(frozen=True)
class CorrectionRule:
    """How a field is corrected; `DeformParams` says more of each value.

    Attributes
    ----------
    rbf_width : float
        Scene units.
    controls : int
        Basis functions.
    control_level : float
        Half of them lie where |sdf| is below it.
    surface_points, anchors : int
        Points of each kind that are drawn, fewer where there are fewer; anchors of each level set.
    ridge : float
    reweightings : int
    residual_scale : float
        Clip distances.
    """

    rbf_width: float
    controls: int
    control_level: float
    surface_points: int
    anchors: int
    ridge: float
    reweightings: int
    residual_scale: float


def correct_zero_crossing(
    sdf: np.ndarray,
    seen: np.ndarray,
    grid: VoxelGrid,
    samples: SurfaceSamples,
    rule: CorrectionRule,
    rng: np.random.Generator,
    note: Callable[[str], None] = lambda message: None,
) -> np.ndarray:
    """Return S = S' + correction, the correction a sum of radial basis functions (Eqs. 16 to 18).

    Differs from the paper: a point counts by its trust, and less the farther the corrected field stays from zero
    there (Cauchy's weights, refitted `reweightings` times): a smooth correction cannot follow a wrong point among
    right ones. With trust 1 and no reweighting it is Eq. 18. Always: functions farther than four widths from a point
    count as 0 in the fit, voxels that no view sees keep their value, and the sum is clipped to [-1, 1], which Eq. 16
    is not.

    Parameters
    ----------
    sdf : (nx, ny, nz) float32
        S', in [-1, 1].
    seen : (nx, ny, nz) uint8
        Voxels that no view sees keep their value.
    grid : VoxelGrid
    samples : SurfaceSamples
    rule : CorrectionRule
    rng : numpy.random.Generator
    note : callable
        Takes a message to report progress.

    Returns
    -------
    (nx, ny, nz) float32, in [-1, 1]
    """
    chosen = rng.permutation(len(samples.xyz))[: rule.surface_points]
    xyz, value, trust = samples.xyz[chosen], samples.sdf[chosen], samples.trust[chosen]
    anchors = draw_anchors(sdf, seen, grid, rule.anchors, rng)
    centres = draw_controls(sdf, grid, rule.controls, rule.control_level, rng)
    basis = place_basis(np.concatenate([xyz, anchors]), centres, rule.rbf_width)
    target = np.concatenate([-value, np.zeros(len(anchors))])
    weight = np.concatenate([trust, np.ones(len(anchors))])
    coefficients = fit_ridge(basis, target, weight, rule.ridge)
    for _ in range(rule.reweightings):
        residual = (basis.combine(coefficients) - target)[: len(xyz)]
        weight[: len(xyz)] = trust / (1 + (residual / rule.residual_scale) ** 2)
        coefficients = fit_ridge(basis, target, weight, rule.ridge)
    left = np.abs(basis.combine(coefficients)[: len(xyz)] + value)
    note(f"field at {len(xyz)} points: median {np.median(np.abs(value)):.3f}, corrected {np.median(left):.3f}")
    corrected = sdf + evaluate_on_grid(grid, centres, coefficients, rule.rbf_width)
    return np.where(seen > 0, np.clip(corrected, -1, 1), sdf).astype(np.float32)
