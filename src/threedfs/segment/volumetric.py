"""The baseline that cuts voxels alone by colours and photo-consistency."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from threedfs.errors import UserError
from threedfs.geometry.grid import voxel_centres
from threedfs.geometry.projection import project
from threedfs.segment.alpha_expansion import expand
from threedfs.segment.color_model import lab_image
from threedfs.segment.energy import BACKGROUND, EMPTY, OBJECT, fold_given
from threedfs.segment.fit_colors import fit_color_model
from threedfs.segment.lookup import find_pixels
from threedfs.segment.outline import draw_voxels
from threedfs.segment.pairwise import voxel_pairs
from threedfs.types import View, VoxelGrid


@dataclass(frozen=True)
class VolumetricRule:
    """Weights of the volumetric cut; `VolumetricCutParams` says more of each value."""

    components: int
    color_pixels: int
    least_posterior: float
    fixation_radius: float
    pair_weight: float
    vote_scale: float
    iterations: int
    stop_share: float


def cut_volume(
    images: Mapping[str, np.ndarray],
    views: Mapping[str, View],
    grid: VoxelGrid,
    height: np.ndarray,
    votes: np.ndarray,
    fixation: np.ndarray,
    rule: VolumetricRule,
    rng: np.random.Generator,
    note: Callable[[str], None] = lambda message: None,
) -> np.ndarray:
    """Label voxels by what colours they project on, and cut where surface points lie.

    The colours of the object are first those around the point that all cameras look at; each cut's silhouettes give
    the next ones. A voxel is the object's where the mean posterior of its projections is above
    `least_posterior`, at a cost that grows with the difference; parting two neighbours costs less where points vote
    for a surface.

    Differs from the source: the votes are semi-dense points; voxels below the support plane are background, as in all
    methods here.

    Parameters
    ----------
    images : mapping of str to (H, W, 3) uint8
        RGB.
    views : mapping of str to View
    grid : VoxelGrid
    height : (nx, ny, nz) float32
        Above the support plane.
    votes : (nx, ny, nz) float32
        Surface points in each voxel.
    fixation : (3,) float64
    rule : VolumetricRule
    rng : numpy.random.Generator
    note : callable

    Returns
    -------
    (nx, ny, nz) uint8
        `OBJECT`, `BACKGROUND` below the plane, `EMPTY` elsewhere.

    Raises
    ------
    UserError
        If no voxel is left.

    References
    ----------
    Campbell, Vogiatzis, Hernandez, Cipolla, Automatic 3D object segmentation in multiple views using volumetric
    graph-cuts, 2010; Vogiatzis, Torr, Cipolla, Multi-view stereo via volumetric graph-cuts, 2005. Section 4.3.
    """
    lab = {name: lab_image(image) for name, image in images.items()}
    is_open = height > 0
    centres = voxel_centres(grid)[is_open]
    pairs = voxel_pairs(is_open)
    share = np.exp(-votes.reshape(-1) / rule.vote_scale)
    weight = rule.pair_weight * np.minimum(share[pairs[:, 0]], share[pairs[:, 1]])
    below = np.full(is_open.size, BACKGROUND, np.uint8)
    graph = fold_given(pairs, weight.astype(np.float32), below, is_open.reshape(-1), 2)
    masks = {name: _around(view, fixation, rule.fixation_radius) for name, view in views.items()}
    model, before, seed = None, None, int(rng.integers(2**31))
    for iteration in range(rule.iterations):
        inside = np.concatenate([lab[name][masks[name]] for name in views])
        around = np.concatenate([lab[name][~masks[name]] for name in views])
        drawn = [pixels[rng.permutation(len(pixels))[: rule.color_pixels]] for pixels in (inside, around)]
        model = fit_color_model(drawn[0], drawn[1], rule.components, model, seed)
        costs = graph.with_costs(_mean_cost(centres, views, lab, model, rule.least_posterior))
        labels = np.zeros(grid.shape, bool)
        labels[is_open] = expand(costs, np.full(len(centres), BACKGROUND, np.uint8), OBJECT) == OBJECT
        if not labels.any():
            raise UserError(
                "volumetric_cut: expected voxels of the object's colours, found none; what the cameras look at has "
                "the colours of its surroundings: raise volumetric_cut.fixation_radius, or leave out volumetric_gc."
            )
        changed = is_open.size if before is None else int((labels != before).sum())
        note(f"iteration {iteration + 1}: {labels.sum()} voxels, {changed} changed")
        before, masks = labels, draw_voxels(labels, grid, views)
        if changed < rule.stop_share * is_open.size:
            break
    return np.where(before, OBJECT, np.where(is_open, EMPTY, BACKGROUND)).astype(np.uint8)


def _around(view, point, radius):
    """Return the disc (H, W) bool around a world point in a view, of a share of the image's shorter side."""
    (u, v), _ = project(view, point)
    rows, columns = np.mgrid[: view.camera.height, : view.camera.width]
    return np.hypot(columns - u, rows - v) <= radius * min(view.camera.shape)


def _mean_cost(centres, views, lab, model, least):
    """Return the cost (N, 2) of background and object by the mean posterior over the views that show each voxel."""
    total, shown = np.zeros(len(centres)), np.zeros(len(centres))
    for name, view in views.items():
        chance = model.posterior(lab[name].reshape(-1, 3)).reshape(view.camera.shape)
        row, column, kept = find_pixels(view, centres)
        total[kept] += chance[row, column]
        shown[kept] += 1
    mean = total / np.maximum(shown, 1)
    return np.stack([mean * (1 - least), (1 - mean) * least], axis=1)
