"""Learn the colours of the object and of its background (Section 3.4, Eqs. 20, 21)."""

from __future__ import annotations

import warnings

import numpy as np
from sklearn.exceptions import ConvergenceWarning
from sklearn.mixture import GaussianMixture

from threedfs.errors import UserError
from threedfs.read_ahead import map_ahead
from threedfs.segment.color_model import ColorModel
from threedfs.segment.mixture import Mixture

_LEAST_VARIANCE = 1.0
"""Of a component along any direction, Lab units squared: noise of a camera, so that a flat colour is no spike."""
_FIRST_STEPS, _NEXT_STEPS = 30, 8
"""Steps of expectation-maximisation from scratch, and from the mixture of the iteration before."""


def fit_color_model(
    object_lab: np.ndarray,
    background_lab: np.ndarray,
    components: int,
    before: ColorModel | None,
    seed: int,
    threads: int = 1,
) -> ColorModel:
    """Fit a mixture to the colours (N, 3) of each region, going on from the model before, if there is one.

    With two threads, both at once; the result is the same.

    Raises
    ------
    UserError
        If a region has fewer pixels than the mixture has components.
    """
    for name, lab in (("object", object_lab), ("background", background_lab)):
        if len(lab) < components:
            raise UserError(
                f"Expected at least {components} pixels of the {name} to learn its colours from, got {len(lab)}; the "
                "fused object is hardly in any keyframe, or fills all of them: check its mesh (method fused_sdf)."
            )
    regions = (
        (object_lab, before and before.of_object, seed),
        (background_lab, before and before.of_background, seed + 1),
    )
    # The steps are few on purpose: each round goes on. Filters of warnings are of the process, so both share one.
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ConvergenceWarning)
        return ColorModel(*map_ahead(lambda region: _fit(region[0], components, *region[1:]), regions, threads=threads))


def _fit(lab, components, before, seed):
    start = (
        {}
        if before is None
        else {
            "weights_init": before.weights / before.weights.sum(),
            "means_init": before.means,
            "precisions_init": np.stack([factor @ factor.T for factor in before.precisions_cholesky]),
        }
    )
    mixture = GaussianMixture(
        components,
        covariance_type="full",
        reg_covar=_LEAST_VARIANCE,
        max_iter=_FIRST_STEPS if before is None else _NEXT_STEPS,
        tol=0,
        random_state=seed,
        init_params="k-means++",
        **start,
    )
    mixture.fit(lab.astype(np.float64))
    return Mixture(mixture.weights_, mixture.means_, mixture.precisions_cholesky_)
