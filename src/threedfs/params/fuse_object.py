"""Parameters of the fuse_object stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter
from threedfs.params.fusion import FusionSettings


@dataclass(frozen=True)
class FuseObjectParams(FusionSettings):
    """How the object is fused on its own grid."""

    grid: str = parameter(
        "object",
        "what the grid covers: the box of the object, or the region of interest, with the very voxels of the scene's "
        "grid, as in the paper, which has one grid",
        equation="Sec. 3.4.1",
        choices=("object", "region"),
    )
    hidden_distance: float = parameter(
        2.0,
        "distance behind a view's surface from which the handicap of votes on voxels that the view does not see grows, "
        "up to hidden at the clip distance: what is behind a thin part is seen by other views; acts with consistency "
        "weighting",
        unit="voxel",
        minimum=0.0,
    )
    thickness_share: float = parameter(
        0.25,
        "largest clip distance as a share of the object's thickness: the field of a thin object must reach -1 inside; "
        "0 for no limit (paper)",
        minimum=0.0,
        maximum=1.0,
    )
    mirrored_height: float = parameter(
        0.07,
        "height over the support plane up to which depth of the coarse object is taken for the plane's mirror image in "
        "an upright face; 0 for none; acts with consistency weighting",
        unit="height of the object",
        minimum=0.0,
        maximum=1.0,
    )
    mirrored_from: float = parameter(
        0.7,
        "mean confidence in the object's depth up to which mirror images are not believed",
        minimum=0.0,
        maximum=1.0,
    )
    mirrored_full: float = parameter(
        0.75,
        "mean confidence in the object's depth from which they are",
        minimum=0.0,
        maximum=1.0,
    )
