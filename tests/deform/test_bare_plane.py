"""Points on the support plane against a field known in closed form: a box on a table with a bump beside it."""

import numpy as np

from threedfs.deform.bare_plane import draw_plane
from threedfs.deform.correction import CorrectionRule, correct_zero_crossing
from threedfs.deform.evidence import SurfaceSamples, sample_field
from threedfs.geometry.grid import cover_box, voxel_centres
from threedfs.types import Plane

GRID = cover_box(np.array([-0.5, -0.5, -0.15]), np.array([0.5, 0.5, 0.45]), 60)
CLIP = 6 * GRID.spacing
BUMP = 0.04
SEEN = np.ones(GRID.shape, np.uint8)
TABLE = Plane(np.array([0.0, 0.0, 1.0]), 0.0)
RULE = CorrectionRule(
    rbf_width=0.12,
    controls=1500,
    control_level=0.5,
    surface_points=1000,
    anchors=300,
    ridge=1.0,
    reweightings=5,
    residual_scale=0.1,
    plane_residual_scale=0.5,
)
TOP = SurfaceSamples(np.array([[0.0, 0.0, 0.3]]), np.zeros(1), np.ones(1))


def field():
    """A box 0.4 wide and 0.3 high on a table that rises by `BUMP` where x > 0.3."""
    x, y, z = np.moveaxis(voxel_centres(GRID), -1, 0)
    box = np.maximum(np.maximum(np.abs(x), np.abs(y)) - 0.2, z - 0.3)
    return np.clip(np.minimum(z - np.where(x > 0.3, BUMP, 0), box) / CLIP, -1, 1).astype(np.float32)


def draw(sdf, seen=SEEN, **changed):
    settings = {"height": 0.05, "reach": 0.9, "trust": 3.0, "count": 2000, "rng": np.random.default_rng(0), **changed}
    return draw_plane(sdf, seen, GRID, TABLE, **settings)


def test_points_lie_on_the_bare_plane():
    """Exact: on the plane, under the bump too, and none under the box; with the field that is there."""
    sdf = field()
    found = draw(sdf)
    np.testing.assert_allclose(found.xyz[:, 2], 0, atol=1e-6)
    assert (np.abs(found.xyz[:, :2]).max(axis=1) > 0.2 - GRID.spacing).all()
    under = found.xyz[:, 0] > 0.3 + GRID.spacing
    assert 0.1 < under.mean() < 0.4
    np.testing.assert_allclose(found.sdf[under], -BUMP / CLIP, atol=1e-4)
    np.testing.assert_allclose(found.sdf, sample_field(sdf, GRID, found.xyz))
    assert (found.trust == 3).all()


def test_what_rises_higher_than_a_bump_stands_on_the_plane():
    """Exact: a lower limit leaves the bump out; a count draws some; voxels that no view sees say nothing."""
    sdf = field()
    assert (draw(sdf, height=0.02).xyz[:, 0] < 0.3 + GRID.spacing).all()
    assert len(draw(sdf, count=100).xyz) == 100 and len(draw(sdf, count=0).xyz) == 0
    assert len(draw(sdf, seen=0 * SEEN).xyz) == 0


def test_what_nothing_is_known_of_is_not_bare():
    """Exact: no view sees the space above a low solid, or the grid ends there: nothing says that it is a bump."""
    sdf, height = field(), voxel_centres(GRID)[..., 2]
    assert len(draw(sdf, seen=(height < 0.06).astype(np.uint8)).xyz) == 0
    low = cover_box(np.array([-0.5, -0.5, -0.15]), np.array([0.5, 0.5, 0.02]), 60)
    solid = np.full(low.shape, -0.5, np.float32)
    settings = {"height": 0.05, "reach": 0.9, "trust": 3.0, "count": 9, "rng": np.random.default_rng(0)}
    assert len(draw_plane(solid, np.ones(low.shape, np.uint8), low, TABLE, **settings).xyz) == 0


def test_a_bump_is_laid_flat_and_the_object_kept():
    """Property: with one surface point, on top of the box, the table is level again, and the box as large as it was."""
    sdf = field()
    corrected = correct_zero_crossing(sdf, SEEN, GRID, TOP, draw(sdf), RULE, np.random.default_rng(0))
    bump = np.stack(np.meshgrid(np.linspace(0.35, 0.45, 5), np.linspace(-0.4, 0.4, 5), [0.5 * BUMP]), -1).reshape(-1, 3)
    assert (sample_field(sdf, GRID, bump) < 0).all()
    assert (sample_field(corrected, GRID, bump) > 0).all()
    above = (voxel_centres(GRID)[..., 2] > BUMP) & (np.abs(voxel_centres(GRID)[..., :2]).max(axis=-1) < 0.25)
    assert abs(((corrected < 0) & above).sum() / ((sdf < 0) & above).sum() - 1) < 0.02
