"""A mesh painted from photographs: their exposure, charts in the shape that one shows, the blend of all."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from threedfs.geometry.faces import face_areas
from threedfs.texture.bake import bake_texture
from threedfs.texture.charts import cut_charts
from threedfs.texture.choose import choose_views, measure_areas
from threedfs.texture.exposure import expose, find_gains
from threedfs.texture.textured import TexturedMesh
from threedfs.texture.vertices import GRAZING, Reader, sample_vertices
from threedfs.types import Mesh, View

_KEPT = 100_000_000
"""Pixels of photographs in memory, each of which is read for every block of texels: 300 MB, or 250 crops."""


@dataclass(frozen=True)
class PaintRule:
    """How the texture is laid out.

    Attributes
    ----------
    seam_cost : float
        As `choose_views` takes it.
    texels : float
        As `cut_charts` takes them. More than 1, as all photographs together show more than one does.
    """

    seam_cost: float
    texels: float


@dataclass(frozen=True)
class Painting:
    """What became of a mesh.

    Attributes
    ----------
    textured : TexturedMesh
    unseen_share : float
        Of the mesh's area, that no photograph shows: painted as what is beside it.
    charts : int
        Pieces that the texture is made of.
    """

    textured: TexturedMesh
    unseen_share: float
    charts: int


def paint_mesh(mesh: Mesh, views: Sequence[View], read_image: Reader, read_valid: Reader, rule: PaintRule) -> Painting:
    """Paint a mesh, each point with the median of the photographs that show it.

    Not in the paper.

    Parameters
    ----------
    mesh : Mesh
        World.
    views : sequence of View
        At most 254.
    read_image, read_valid : callable
        Give the image (H, W, 3) uint8 RGB of a view by its name, and which pixels (H, W) bool show the scene.
    rule : PaintRule
    """
    samples = sample_vertices(mesh, views, read_image, read_valid, GRAZING)
    gains = find_gains(samples)
    gain_of = {view.name: gain for view, gain in zip(views, gains, strict=True)}

    @lru_cache(_KEPT // max(view.camera.width * view.camera.height for view in views))
    def read_exposed(name: str) -> np.ndarray:
        return expose(read_image(name), gain_of[name])

    areas = measure_areas(mesh, views, samples)
    chosen = choose_views(mesh, areas, rule.seam_cost)
    atlas = cut_charts(mesh, views, chosen, rule.texels)
    whole = face_areas(mesh)
    return Painting(
        bake_texture(mesh, views, atlas, areas, read_exposed),
        float(whole[chosen < 0].sum() / whole.sum()),
        len(atlas.view),
    )
