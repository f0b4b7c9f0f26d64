"""Property: how many masks may be wrong goes by what is known of the object."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from slab import CAMERA, GRID, VIEWS, confirm, make_slab
from test_held import draw

from threedfs.params.rules import make_rule
from threedfs.params.surface import SurfaceParams
from threedfs.surface.complete import HullRule
from threedfs.surface.shape import ShapeRule, shape_surface
from threedfs.types import Plane

PLANE = Plane(np.array([0.0, 0, 1]), 0.0)
WHOLE = {name: np.ones(CAMERA.shape, bool) for name in VIEWS}


@pytest.fixture(scope="module")
def masks():
    """Masks of a slab; the first lacks its upper half."""
    drawn = draw(make_slab())
    low = make_slab()
    low[:, :, 8:] = 1
    return drawn | {next(iter(VIEWS)): next(iter(draw(low).values()))}


def volume(masks, sureness, roundness, hull_tolerance, bare_tolerance):
    """Return the volume of the surface, voxels, by masks alone: no depth is believed."""
    params = SurfaceParams(hull_tolerance=hull_tolerance, bare_tolerance=bare_tolerance, hull_trust=1.0, gap_views=99)
    rule = make_rule(ShapeRule, params, complete=make_rule(HullRule, params))
    depth = replace(confirm(make_slab(), sureness, trust=0.0), roundness=roundness)
    mesh = shape_surface(depth, PLANE, masks, VIEWS, WHOLE, rule)
    return trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).volume / GRID.spacing**3


@pytest.mark.parametrize(("sureness", "roundness"), [(1.0, 0.0), (0.0, 1.0)])
def test_sure_and_round_objects_have_the_one_bare_ones_the_other(masks, sureness, roundness):
    many, few = 0.15, 0.0
    loose, tight = volume(masks, sureness, roundness, many, few), volume(masks, 0.0, 0.0, many, few)
    assert tight < 0.8 * loose
    assert volume(masks, 0.0, 0.0, few, many) == volume(masks, 0.0, 0.0, many, many) > tight
