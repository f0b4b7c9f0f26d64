"""The surface that the object stands on."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from threedfs.errors import UserError
from threedfs.geometry.plane import fit_plane, propose_planes, score_planes
from threedfs.types import Plane

_FACING = np.cos(np.radians(45))  # a point lies on a plane if its normal is so near the plane's
_FEWEST = 100  # points from which they may tell the plane
_SAMPLE = 4000  # surface points on which candidate planes are compared


@dataclass(frozen=True)
class SupportRule:
    """What makes a plane the support.

    Attributes
    ----------
    tolerance : float
        Distance up to which a surface point lies on a plane, scene units; doubled while no plane is found.
    doublings : int
        Times it may be doubled: the fused surface of a floor without texture is rough.
    reach : float
        Standard deviation of the weight of surface points around the fixation point, scene units: a wall of the
        room may be larger than the table, but it is not near what all views look at.
    max_tilt : float
        Largest angle between the support's normal and the cameras' mean upward direction, degrees.
    min_share : float
        Least share of the upward-facing surface, weighted by its nearness, that lies on the plane.
    candidates : int
        Planes tried.
    """

    tolerance: float
    doublings: int
    reach: float
    max_tilt: float
    min_share: float
    candidates: int


@dataclass(frozen=True)
class SupportPlane:
    """The support found.

    Attributes
    ----------
    plane : Plane
    share : float
        Share of the upward-facing surface, weighted by its nearness, that lies on it.
    noise : float
        Robust standard deviation of that surface from the plane, scene units.
    extent : float
        Mean over the three axes of the standard deviation of the points on the plane, scene units (Sec. 3.4.2).
    """

    plane: Plane
    share: float
    noise: float
    extent: float


def find_support(
    surface: np.ndarray,
    normals: np.ndarray,
    points: np.ndarray,
    centres: np.ndarray,
    fixation: np.ndarray,
    up: np.ndarray,
    rule: SupportRule,
    generator: np.random.Generator,
) -> SupportPlane:
    """Find the plane under the object among points of the fused surface, or else among the semi-dense points.

    Candidates are planes through three upward-facing points. Each scores by the nearby surface that lies on it
    and faces its way, times the cosine between its normal and `up`, less the nearby surface that lies below it:
    a table's top has nothing below, a box's top has the table. Cameras must be on its positive side.

    Where the semi-dense points have a plane at a finer tolerance than the fused surface, theirs is taken: fused
    from uncertain depth, a surface has layers below the true one. Otherwise the surface's, settled on points near it
    (`settle_support`).

    Differs from the paper: Sec. 3.4.2 fits one plane to all points of the zero level surface, which takes a
    wall, or a compromise, where the floor is not the largest surface.

    Parameters
    ----------
    surface, normals : (N, 3) float64
        Of the zero level surface, normals toward empty space.
    points : (M, 3) float64
        Semi-dense points.
    centres : (K, 3) float64
        Camera centres.
    fixation, up : (3,) float64
    rule : SupportRule
    generator : numpy.random.Generator

    Raises
    ------
    UserError
        If no plane reaches `rule.min_share`, neither of the surface nor of the points.
    """
    found, share, doublings = _widen(surface, normals, centres, fixation, up, rule, generator)
    if found is not None and doublings == 0:
        return settle_support(found, points, centres, fixation, up, rule, generator)
    # Points have no normals: the object's own count among those that the share is of.
    halved = replace(rule, min_share=rule.min_share / 2)
    upward = np.broadcast_to(up, points.shape)
    told, points_share, points_doublings = _widen(points, upward, centres, fixation, up, halved, generator)
    if told is not None and points_doublings < doublings:
        return told
    if found is not None:
        return settle_support(found, points, centres, fixation, up, rule, generator)
    raise UserError(_explain(max(share, points_share), rule))


def _widen(
    points: np.ndarray,
    normals: np.ndarray,
    centres: np.ndarray,
    fixation: np.ndarray,
    up: np.ndarray,
    rule: SupportRule,
    generator: np.random.Generator,
) -> tuple[SupportPlane | None, float, int]:
    """Search at wider and wider tolerance for a plane with enough share.

    Returns
    -------
    plane : SupportPlane or None
    share : float
        The best met.
    doublings : int
        Of the tolerance at which the plane was found; one more than allowed where there is none.
    """
    none = rule.doublings + 1
    if len(points) < _FEWEST:
        return None, 0.0, none
    weights = np.exp(-((points - fixation) ** 2).sum(axis=1) / (2 * rule.reach**2))
    upward = normals @ up > np.cos(np.radians(rule.max_tilt))
    best = 0.0
    if not (weights * upward).sum() > 0:
        return None, best, none
    for doubling in range(rule.doublings + 1):
        tolerance = rule.tolerance * 2**doubling
        plane = _search(points, normals, weights, centres, up, tolerance, rule, generator)
        if plane is None:
            continue
        on = _lies_on(plane, points, normals, tolerance)
        share = float((weights * on).sum() / (weights * upward).sum())
        best = max(best, share)
        if share >= rule.min_share:
            noise = 1.4826 * float(np.median(np.abs(plane.distance(points[on]))))
            return SupportPlane(plane, share, noise, float(points[on].std(axis=0).mean())), best, doubling
    return None, best, none


def settle_support(
    found: SupportPlane,
    points: np.ndarray,
    centres: np.ndarray,
    fixation: np.ndarray,
    up: np.ndarray,
    rule: SupportRule,
    generator: np.random.Generator,
) -> SupportPlane:
    """Move the support onto semi-dense points near it, where these tell it more sharply than the fused surface.

    Where depth is uncertain, as on a floor without texture, the soft maximum sinks the surface below the floor
    by the largest error of any view; the few points measured there do not sink.

    Parameters
    ----------
    found : SupportPlane
    points : (N, 3) float64
        Semi-dense points.
    centres, fixation, up, rule, generator
        As for `find_support`.

    Returns
    -------
    SupportPlane
        `found` itself where too few points agree on a plane near it, or scatter more than the surface does.
    """
    near = points[np.abs(found.plane.distance(points)) < 4 * found.noise + rule.tolerance]
    if len(near) < _FEWEST:
        return found
    weights = np.exp(-((near - fixation) ** 2).sum(axis=1) / (2 * rule.reach**2))
    normals = np.broadcast_to(found.plane.normal, near.shape)
    plane = _search(near, normals, weights, centres, up, rule.tolerance, rule, generator)
    if plane is None:
        return found
    on = _lies_on(plane, near, normals, rule.tolerance)
    noise = 1.4826 * float(np.median(np.abs(plane.distance(near[on]))))
    share = float((weights * on).sum() / weights.sum())
    if share < rule.min_share or noise > found.noise:
        return found
    return SupportPlane(plane, share, noise, float(near[on].std(axis=0).mean()))


def _search(
    points: np.ndarray,
    normals: np.ndarray,
    weights: np.ndarray,
    centres: np.ndarray,
    up: np.ndarray,
    tolerance: float,
    rule: SupportRule,
    generator: np.random.Generator,
) -> Plane | None:
    """Return the best plane at one tolerance, fitted to all points that lie on it; None where there is none."""
    least_cosine = np.cos(np.radians(rule.max_tilt))
    chosen = generator.choice(len(points), size=_SAMPLE, p=weights / weights.sum())
    sample, sample_normals = points[chosen], normals[chosen]

    def score(candidates: np.ndarray, distances: np.ndarray) -> np.ndarray:
        facing = candidates @ sample_normals.T > _FACING
        on = np.clip(1 - (distances / tolerance) ** 2, 0, None) * facing
        below = distances < -2 * tolerance
        return (candidates @ up) * on.sum(axis=1) - below.sum(axis=1)

    probabilities = weights * (normals @ up > least_cosine)
    drawn, offsets = propose_planes(points, probabilities / probabilities.sum(), rule.candidates, generator)
    sign = np.where(drawn @ up < 0, -1.0, 1.0)
    drawn, offsets = drawn * sign[:, None], offsets * sign
    allowed = drawn @ up > least_cosine
    allowed &= np.mean(centres @ drawn.T + offsets > tolerance, axis=0) > 0.9
    drawn, offsets = drawn[allowed], offsets[allowed]
    if len(drawn) == 0:
        return None
    best = int(np.argmax(score_planes(drawn, offsets, sample, score)))
    plane = Plane(drawn[best], float(offsets[best]))
    for _ in range(5):
        on = _lies_on(plane, points, normals, tolerance)
        if on.sum() < 3:
            return None
        fitted = fit_plane(points[on], weights[on])
        plane = fitted if fitted.normal @ up > 0 else Plane(-fitted.normal, -fitted.offset)
    return plane if plane.normal @ up > least_cosine else None


def _lies_on(plane: Plane, points: np.ndarray, normals: np.ndarray, tolerance: float) -> np.ndarray:
    return (np.abs(plane.distance(points)) < tolerance) & (normals @ plane.normal > _FACING)


def _explain(share: float, rule: SupportRule) -> str:
    return (
        f"No support plane was found: expected a flat surface under the object with at least {rule.min_share:.0%} of "
        f"the upward-facing surface on it, the best has {share:.0%}; film the object on a flat, textured surface that "
        "stays in the picture, from above it, or raise locate.plane_tolerance."
    )
