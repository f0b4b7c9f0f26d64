"""Silhouettes and masks of a mesh, written for every keyframe."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from threedfs.io.images import write_mask
from threedfs.io.volumes import write_silhouettes
from threedfs.object.silhouettes import draw_silhouette, draw_source_silhouette
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
