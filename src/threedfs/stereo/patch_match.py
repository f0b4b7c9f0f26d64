"""Patch-match stereo: the depth and slope of every pixel's patch by guessing, spreading and refining."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from threedfs.depth.zncc import MISSING
from threedfs.frames.scale import scale_camera
from threedfs.geometry.rigid import invert
from threedfs.stereo.sweep import improve_planes, refine_depth
from threedfs.types import View

# Where hypotheses are taken from, of the other colour of the checkerboard: beside the pixel, and farther away.
_BESIDE = np.array([(-1, 0), (1, 0), (0, -1), (0, 1)], np.int64)
_AROUND = np.array([*_BESIDE, (-5, 0), (5, 0), (0, -5), (0, 5)], np.int64)


@dataclass(frozen=True)
class PatchMatch:
    """Slanted patches of a keyframe.

    Attributes
    ----------
    inverse_depth : (H, W) float64, 1 / scene unit, NaN where nothing is known
    slope : (H, W, 2) float64, its change per pixel along columns and rows
    cost : (H, W) float64, (1 - NCC) / 2 averaged over the views that match best; 1 where nothing is known
    """

    inverse_depth: np.ndarray
    slope: np.ndarray
    cost: np.ndarray


@dataclass(frozen=True)
class PatchRule:
    """How patches are compared; see `StereoParams` for each value."""

    radius: int
    stride: int
    likeness: float
    variance_floor: float
    least_variance: float
    best_views: int


def match_patches(
    reference: View,
    grey: np.ndarray,
    neighbours: Sequence[View],
    images: Sequence[np.ndarray],
    measured: np.ndarray,
    wanted: np.ndarray,
    *,
    near: float,
    far: float,
    rule: PatchRule,
    levels: int,
    rounds: int,
    seed: int,
    note: Callable[[str], None] = lambda message: None,
) -> PatchMatch:
    """Find for every pixel the plane through which its patch looks alike in the neighbours.

    Guesses are made on the coarsest level of the image pyramid; finer levels start from it and only refine.

    Parameters
    ----------
    reference : View
    grey : (H, W) float32
        Centred grey levels, `MISSING` where the image shows nothing.
    neighbours, images : sequences of View and of (H2, W2) float32
        What the patch is sought in, in the same form; each may have a shape of its own.
    measured : (H, W) float64
        Inverse depth to start from, NaN where there is none.
    wanted : (H, W) bool
        Pixels that are matched.
    near, far : float
        Depths between which patches are sought, scene units.
    rule : PatchRule
    levels : int
        Levels of the pyramid, each half the size of the one before.
    rounds : int
        Sweeps over the coarsest level; half as many on each finer one, at least one.
    seed : int
    note : callable
        Takes a message to report progress.

    Returns
    -------
    PatchMatch

    Notes
    -----
    The scheme is that of patch-match stereo on a checkerboard (Bleyer et al. 2011, Galliani et al. 2015).
    """
    comparison = (
        patch_offsets(rule.radius, rule.stride),
        1 / rule.likeness,
        rule.variance_floor,
        rule.least_variance,
        min(rule.best_views, len(neighbours)),
    )
    planes = None
    for level in reversed(range(levels)):
        shape = _shape_at(level, grey.shape)
        view = _resize_view(reference, shape)
        small = _shrink(grey, shape)
        shrunk = [_shrink(image, _shape_at(level, image.shape)) for image in images]
        resized = [_resize_view(each, image.shape) for each, image in zip(neighbours, shrunk, strict=True)]
        views = (_stack(shrunk), *neighbour_maps(view, resized))
        if planes is None:
            planes = guess_planes(_sample(measured, shape), near, far, np.random.default_rng(seed))
        else:
            planes = _refine_grid(planes, shape)
        coarsest = level == levels - 1
        cost = np.full(shape, np.inf)
        here = _sample(wanted, shape)
        for turn in range(max(1, rounds >> (levels - 1 - level))):
            for colour in (0, 1):
                improve_planes(
                    small,
                    here,
                    views,
                    comparison,
                    planes,
                    cost,
                    (1 / far, 1 / near),
                    view.camera.fx,
                    _AROUND if coarsest else _BESIDE,
                    coarsest,
                    0.5 ** (turn + levels - 1 - level),
                    colour,
                    np.uint64((seed * 97 + level) * 97 + turn + 1),
                )
        if level == 0:
            refine_depth(small, views, comparison, planes, cost)
        note(f"level {level}: {100 * (cost < 0.1).sum() / max(here.sum(), 1):.0f} % of the patches match")
    planes[cost >= 1] = np.nan
    return PatchMatch(planes[..., 0], planes[..., 1:], np.minimum(cost, 1.0))


def guess_planes(measured: np.ndarray, near: float, far: float, rng: np.random.Generator) -> np.ndarray:
    """Start from measured inverse depths and, where there is none, at random; fronto-parallel; (H, W, 3) float64."""
    planes = np.zeros((*measured.shape, 3))
    random = rng.uniform(1 / far, 1 / near, measured.shape)
    planes[..., 0] = np.where(np.isfinite(measured), measured, random)
    return planes


def patch_offsets(radius: int, stride: int) -> np.ndarray:
    """List the samples of a patch: (2, S) int32 offsets along columns and rows."""
    steps = np.arange(-radius, radius + 1, stride, dtype=np.int32)
    return np.stack(np.meshgrid(steps, steps)).reshape(2, -1)


def neighbour_maps(reference: View, neighbours: Sequence[View]) -> tuple[np.ndarray, np.ndarray]:
    """Return the maps (N, 3, 3) of pixels at infinity into the neighbours, and their epipoles (N, 3).

    A pixel x at inverse depth w is seen at ``infinity @ x + epipole * w``, homogeneous.
    """
    back = np.linalg.inv(reference.camera.px_from_cam)
    between = [view.cam_from_world @ invert(reference.cam_from_world) for view in neighbours]
    pairs = list(zip(neighbours, between, strict=True))
    infinity = [view.camera.px_from_cam @ relative[:3, :3] @ back for view, relative in pairs]
    epipole = [view.camera.px_from_cam @ relative[:3, 3] for view, relative in pairs]
    return np.array(infinity), np.array(epipole)


def _shape_at(level: int, shape: tuple[int, int]) -> tuple[int, int]:
    return tuple(-(-side // 2**level) for side in shape)


def _stack(images: Sequence[np.ndarray]) -> np.ndarray:
    """Stack images of any shapes: (N, H, W) float32, `MISSING` beyond each."""
    shape = np.max([image.shape for image in images], axis=0)
    stack = np.full((len(images), *shape), MISSING)
    for place, image in zip(stack, images, strict=True):
        place[: image.shape[0], : image.shape[1]] = image
    return stack


def _resize_view(view: View, shape: tuple[int, int]) -> View:
    return View(view.name, scale_camera(view.camera, shape, view.name), view.cam_from_world)


def _shrink(grey: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    if grey.shape == shape:
        return grey
    return cv2.resize(grey, shape[::-1], interpolation=cv2.INTER_AREA)


def _nearest(shape: tuple[int, int], source: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Positions (rows, columns) of a grid's pixels in another grid over the same image."""
    rows, columns = ((np.arange(side) + 0.5) * other / side - 0.5 for side, other in zip(shape, source, strict=True))
    return rows[:, None], columns[None, :]


def _sample(values: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    rows, columns = _nearest(shape, values.shape)
    return values[np.round(rows).astype(int), np.round(columns).astype(int)]


def _refine_grid(planes: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """Give each pixel of a finer grid the plane of the coarse pixel over it, continued to its own centre."""
    rows, columns = _nearest(shape, planes.shape[:2])
    row, column = np.round(rows).astype(int), np.round(columns).astype(int)
    inverse_depth, along, down = np.moveaxis(planes[row, column], -1, 0)
    inverse_depth = inverse_depth + along * (columns - column) + down * (rows - row)
    return np.stack([inverse_depth, along * planes.shape[1] / shape[1], down * planes.shape[0] / shape[0]], axis=-1)
