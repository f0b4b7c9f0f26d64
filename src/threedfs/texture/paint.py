"""A mesh painted from photographs: exposure, choice of a photograph for each face, charts, seams, texture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from threedfs.geometry.faces import face_areas
from threedfs.texture.bake import bake_texture
from threedfs.texture.charts import cut_charts
from threedfs.texture.choose import ChoiceRule, choose_views
from threedfs.texture.exposure import apply_gains, expose, find_gains
from threedfs.texture.level import level_seams
from threedfs.texture.textured import TexturedMesh
from threedfs.texture.vertices import GRAZING, Reader, sample_vertices
from threedfs.types import Mesh, View


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


def paint_mesh(mesh: Mesh, views: Sequence[View], read_image: Reader, read_valid: Reader, rule: ChoiceRule) -> Painting:
    """Paint a mesh, each face from the one photograph that shows it best.

    Not in the paper.

    Parameters
    ----------
    mesh : Mesh
        World.
    views : sequence of View
        At most 254.
    read_image, read_valid : callable
        Give the image (H, W, 3) uint8 RGB of a view by its name, and which pixels (H, W) bool show the scene.
    rule : ChoiceRule
    """
    samples = sample_vertices(mesh, views, read_image, read_valid, GRAZING)
    gains = find_gains(samples)
    gain_of = {view.name: gain for view, gain in zip(views, gains, strict=True)}

    def read_exposed(name: str) -> np.ndarray:
        return expose(read_image(name), gain_of[name])

    chosen = choose_views(mesh, views, apply_gains(samples, gains), rule)
    atlas = cut_charts(mesh, views, chosen)
    added = level_seams(mesh, views, chosen, read_exposed)
    areas = face_areas(mesh)
    return Painting(
        bake_texture(mesh, views, atlas, added, read_exposed),
        float(areas[chosen < 0].sum() / areas.sum()),
        len(atlas.view),
    )
