"""How far the object reaches by what images show, where the fused scene may hold only a part of it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from threedfs.hull.gaps import fit_masks
from threedfs.segment.energy import OBJECT
from threedfs.segment.gather import GatherRule, Scene, gather_images, gather_voxels, picture_support
from threedfs.segment.joint import CutRule, segment_jointly
from threedfs.segment.outline import largest_piece

_RAMP, _TOLERANCE, _VIEWS = 3.0, 0.5, 4
"""Of the fit to masks: voxels, share of the views, views. Half of the views may miss a part: a box needs no outline."""


def find_extent(
    scene: Scene,
    gather: GatherRule,
    cut: CutRule,
    rng: np.random.Generator,
    note: Callable[[str], None],
    threads: int = 1,
) -> np.ndarray:
    """Return the object's voxels (nx, ny, nz) bool by a joint segmentation of small images and the scene's voxels.

    Not in the paper. To the labelled voxels come those of the masks' hull that fill gaps in the masks.

    Parameters
    ----------
    scene : Scene
        On a part of the scene's grid with room around what is known of the object.
    gather : GatherRule
    cut : CutRule
    rng : numpy.random.Generator
    note : callable
        Takes a message to report progress.
    threads : int
        Cores used; the result does not depend on it.
    """
    volume, bounds = gather_voxels(scene, gather)
    table = picture_support(scene, bounds, gather, threads)
    images = gather_images(scene, volume, bounds, table, gather, rng, threads)
    found = segment_jointly(images, volume, cut, rng, note, threads)
    voxels = found.voxels == OBJECT
    if not voxels.any():
        return voxels
    masks = {name: images[name].superpixels.paint(own == OBJECT) for name, own in found.superpixels.items()}
    _, filled = fit_masks(
        scene.sdf,
        voxels,
        scene.located.height > 0,
        masks,
        scene.views,
        scene.valid,
        scene.located.grid,
        ramp=_RAMP,
        tolerance=_TOLERANCE,
        least_views=_VIEWS,
        threads=threads,
    )
    return largest_piece(voxels | filled)
