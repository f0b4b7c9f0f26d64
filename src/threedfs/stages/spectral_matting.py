"""The object in each keyframe by spectral matting, one image at a time."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from threedfs.io.crops import read_crops
from threedfs.io.keyframes import read_keyframes
from threedfs.io.located import read_located
from threedfs.io.segmentation import Segmentation, write_segmentation
from threedfs.io.volumes import read_volume
from threedfs.job import Job
from threedfs.matting.components import ComponentRule
from threedfs.matting.spectral import SpectralRule, matte_image
from threedfs.matting.trimap import BoundsRule, draw_trimaps
from threedfs.params.rules import make_rule
from threedfs.params.schema import make_params
from threedfs.params.segment import SegmentParams
from threedfs.params.spectral_matting import SpectralMattingParams

_OBJECT = 0.5
"""Opacity above which a pixel is the object's."""


def run(
    *,
    field: Path,
    located: Path,
    keyframes: Path,
    crops: Path,
    labels: Path,
    segmentation: Mapping[str, Any],
    params: SpectralMattingParams,
    job: Job,
) -> None:
    """Read a field, the object in it and the keyframes; write the labels of pixels, and none of voxels.

    What bounds the object is as in the joint segmentation, by its settings `segmentation`, but for the under-estimate.

    Raises
    ------
    UserError
        If no part of the object is known for certain.
    """
    place, store = read_located(located), read_crops(crops)
    views = {name: entry.view for name, entry in read_keyframes(keyframes).items()}
    bounds = make_rule(BoundsRule, make_params(SegmentParams, segmentation), inner_level=params.inner_level)
    valid = {name: store.valid_of(name) for name in views}
    trimaps = draw_trimaps(place, read_volume(field).sdf, views, valid, bounds)
    rule = make_rule(SpectralRule, params, components=make_rule(ComponentRule, params))
    masks = {}
    for name in job.progress.track(views, "keyframe", len(views)):
        generator = np.random.default_rng(job.seed)  # a keyframe does not depend on those before it
        masks[name] = matte_image(store.image(name), trimaps[name], rule, generator) > _OBJECT
    lost = [name for name, trimap in trimaps.items() if trimap.outer.any() and not trimap.inner.any()]
    if lost:
        job.progress.note(f"nothing of the object is certain in {len(lost)} of {len(views)}: {', '.join(lost)}")
    none, no_voxels = np.zeros(0), np.zeros((0, 0, 0), np.uint8)
    write_segmentation(labels, Segmentation(masks, place.grid, no_voxels, none, none.astype(np.int64)), job.header)
