"""Properties of the mesh's smoothing: noise goes, edges and place stay, the mesh stays closed."""

from __future__ import annotations

import numpy as np
import pytest

from threedfs.evaluate.mesh_error import is_closed
from threedfs.geometry.grid import cover_box, voxel_centres
from threedfs.object.extract import enclosed_volume, extract_surface
from threedfs.object.smooth import smooth_mesh
from threedfs.types import Box, Mesh


@pytest.fixture(scope="module")
def ball() -> Mesh:
    """A ball of radius 0.6."""
    grid = cover_box(Box(np.eye(3), -np.ones(3), np.ones(3)), 40)
    return extract_surface((np.linalg.norm(voxel_centres(grid), axis=-1) - 0.6).astype(np.float32), grid)


def test_noise_on_a_ball_is_smoothed_away(ball):
    rng = np.random.default_rng(0)
    rough = Mesh(ball.vertices + rng.normal(0, 0.004, ball.vertices.shape), ball.faces)
    smooth = smooth_mesh(rough, 5, 1.0)
    spread = [np.linalg.norm(mesh.vertices, axis=1).std() for mesh in (rough, smooth)]
    assert spread[1] < 0.5 * spread[0]
    assert enclosed_volume(smooth) == pytest.approx(enclosed_volume(ball), rel=0.06)
    assert is_closed(smooth)


def test_sharp_edges_stay_where_contrast_is_low():
    grid = cover_box(Box(np.eye(3), -np.ones(3), np.ones(3)), 30)
    cube = extract_surface((np.abs(voxel_centres(grid)).max(axis=-1) - 0.6).astype(np.float32), grid)
    kept, blurred = smooth_mesh(cube, 10, 0.02), smooth_mesh(cube, 10, 10.0)
    corner = [np.linalg.norm(mesh.vertices, axis=1).max() for mesh in (cube, kept, blurred)]
    assert corner[0] - corner[1] < 0.3 * (corner[0] - corner[2])


def test_place_of_the_origin_does_not_matter(ball):
    there = smooth_mesh(Mesh(ball.vertices + 7.0, ball.faces), 4, 0.5)
    assert there.vertices - 7.0 == pytest.approx(smooth_mesh(ball, 4, 0.5).vertices, abs=1e-9)


def test_no_steps_change_nothing(ball):
    assert np.array_equal(smooth_mesh(ball, 0, 0.5).vertices, ball.vertices)
