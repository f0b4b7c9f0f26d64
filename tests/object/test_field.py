"""Property tests of the object's own field."""

import numpy as np
import pytest

from threedfs.locate.height import height_above
from threedfs.object.field import mask_field
from threedfs.types import Plane, VoxelGrid

GRID = VoxelGrid(np.zeros(3), 0.1, (40, 40, 30))
TABLE = Plane(np.array([0.0, 0, 1]), -0.45)


@pytest.mark.parametrize("median_size", [1, 3])
def test_field_is_negative_in_the_object_alone(median_size):
    """Property: others and what is under the plane become empty; the zero level beside the object stays in place."""
    interior = np.zeros(GRID.shape, bool)
    interior[16:24, 17:24, 5:14] = True
    interior[:, 33:, :] = True
    interior[:, :, :5] = True
    sdf = np.where(interior, np.float32(-0.5), np.float32(0.25))
    owned = np.zeros(GRID.shape, bool)
    owned[16:24, 17:24, 5:14] = True
    field = mask_field(sdf, owned, height_above(TABLE, GRID), GRID.spacing, median_size)
    differs = (field < 0) != owned
    edges = 4 * (8 + 7 + 9) - 2 * 8  # a voxel on an edge of the block has 12 of 27 in it: the median empties it
    assert differs.sum() == (0 if median_size == 1 else edges) and not (differs & ~owned).any()
    assert (field[15, 17:24, 6:14] == np.float32(0.25)).all()
    assert field[20, 20, 5] == pytest.approx(-0.5)
    assert field[20, 20, 4] == pytest.approx(0.5, abs=1e-5), "half a voxel below the plane"
