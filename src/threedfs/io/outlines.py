"""Silhouettes and masks, of a mesh or of labelled pixels, written for every keyframe."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
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
    names = [view.name for view in views]
    filmed = ((name, draw_source_silhouette(surface, whole[name], distortion, source_shape)) for name in names)
    write_silhouettes(silhouettes, {view.name: draw_silhouette(surface, view) for view in views}, header)
    _write_filmed(masks, filmed)


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
    _write_filmed(masks, distort_masks(drawn, views, whole, distortion, source_shape))


def _write_filmed(folder: Path, masks: Iterable[tuple[str, np.ndarray]]) -> None:
    """Write masks (Hs, Ws) bool, with their names, as `NAME.png`."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, mask in masks:
        write_mask(folder / f"{name}.png", mask)
