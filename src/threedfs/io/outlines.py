"""Silhouettes and masks, of a mesh or of labelled pixels, written for every keyframe."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from threedfs.io.images import write_mask
from threedfs.io.volumes import write_silhouettes
from threedfs.object.silhouettes import draw_silhouette, draw_source_silhouette
from threedfs.segment.source_mask import distort_masks
from threedfs.types import Mesh, View


def write_outlines(
    silhouettes: Path,
    masks: Path,
    surface: Mesh,
    views: Sequence[View],
    whole: Mapping[str, View],
    distortion: tuple[float, float],
    source_shape: tuple[int, int],
    header: Mapping[str, Any],
) -> None:
    """Write a mesh's silhouettes in the undistorted views, and its masks in the frames as they were filmed.

    Parameters
    ----------
    silhouettes : Path
        One file for all views.
    masks : Path
        Folder of `VIEW.png`.
    surface : Mesh
        World.
    views : sequence of View
        Undistorted crops.
    whole : mapping of str to View
        Whole undistorted frames at any resolution, by name.
    distortion, source_shape
        As `draw_source_silhouette` takes them.
    header : mapping
    """
    write_silhouettes(silhouettes, {view.name: draw_silhouette(surface, view) for view in views}, header)
    masks.mkdir(parents=True, exist_ok=True)
    for view in views:
        write_mask(
            masks / f"{view.name}.png", draw_source_silhouette(surface, whole[view.name], distortion, source_shape)
        )


def write_masks(
    silhouettes: Path,
    masks: Path,
    drawn: Mapping[str, np.ndarray],
    views: Mapping[str, View],
    whole: Mapping[str, View],
    distortion: tuple[float, float],
    source_shape: tuple[int, int],
    header: Mapping[str, Any],
) -> None:
    """Write masks of undistorted views as they are, and in the frames as they were filmed.

    Parameters
    ----------
    drawn : mapping of str to (H, W) bool
    views : mapping of str to View
        Undistorted crops.
    silhouettes, masks, whole, distortion, source_shape, header
        As `write_outlines` takes them.
    """
    write_silhouettes(silhouettes, drawn, header)
    masks.mkdir(parents=True, exist_ok=True)
    for name, mask in distort_masks(drawn, views, whole, distortion, source_shape):
        write_mask(masks / f"{name}.png", mask)
