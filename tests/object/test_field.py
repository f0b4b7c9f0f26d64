"""Property tests of the object's own field."""

import numpy as np
import pytest

from threedfs.locate.height import height_above
from threedfs.object.field import mask_field
from threedfs.types import Plane, VoxelGrid

GRID = VoxelGrid(np.zeros(3), 0.1, (40, 40, 30))
TABLE = Plane(np.array([0.0, 0, 1]), -0.45)


@pytest.mark.parametrize("medians", [0, 1])
def test_field_is_negative_in_the_object_alone(medians):
    """Property: others and what is under the plane become empty; the zero level beside the object stays in place."""
    interior = np.zeros(GRID.shape, bool)
    interior[16:24, 17:24, 5:14] = True
    interior[:, 33:, :] = True
    interior[:, :, :5] = True
    sdf = np.where(interior, np.float32(-0.5), np.float32(0.25))
    owned = np.zeros(GRID.shape, bool)
    owned[16:24, 17:24, 5:14] = True
    field = mask_field(sdf, owned, height_above(TABLE, GRID), GRID.spacing, medians)
    np.testing.assert_array_equal(field < 0, owned)  # at a corner of the block four of the seven voxels are in it
    assert (field[15, 17:24, 6:14] == np.float32(0.25)).all()
    assert field[20, 20, 5] == pytest.approx(-0.5)
    assert field[20, 20, 4] == pytest.approx(0.5, abs=1e-5), "half a voxel below the plane"


def test_the_median_takes_off_spikes_and_fills_pits_of_a_voxel():
    """Exact: they go with it and stay without."""
    owned = np.zeros(GRID.shape, bool)
    owned[16:24, 17:24, 5:14] = True
    owned[15, 20, 10] = True
    owned[23, 20, 10] = False
    sdf = np.where(owned, np.float32(-0.5), np.float32(0.25))
    rough, smooth = (
        mask_field(sdf, owned, height_above(TABLE, GRID), GRID.spacing, medians)[[15, 23], 20, 10] < 0
        for medians in (0, 1)
    )
    assert rough.tolist() == [True, False]
    assert smooth.tolist() == [False, True]
