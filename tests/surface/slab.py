"""A slab seen from above by a ring of cameras, and depth maps of solids on its grid."""

import numpy as np

from threedfs.fusion.softmax import SoftMaximum
from threedfs.geometry.projection import backproject_map
from threedfs.geometry.raycast import RayCaster
from threedfs.geometry.rigid import look_at
from threedfs.object.extract import extract_surface
from threedfs.surface.confirmed import ConfirmedDepth
from threedfs.types import Camera, View, VoxelGrid

CAMERA = Camera(120, 120, 150.0, 150.0, 59.5, 59.5)
GRID = VoxelGrid(np.array([-0.5, -0.5, 0.0]), 0.025, (41, 41, 25))


def look_from(angle, rise=1.4):
    centre = np.array([np.cos(angle), np.sin(angle), rise])
    return View(f"{angle:.2f}", CAMERA, look_at(centre, np.array([0, 0, 0.3]), np.array([0.0, 0, 1])))


VIEWS = {view.name: view for view in (look_from(angle) for angle in 2 * np.pi * np.arange(10) / 10)}


def make_slab():
    """Return the field of a slab 16 voxels high that leaves 4 voxels free on each side."""
    field = np.ones(GRID.shape, np.float32)
    field[4:-4, 4:-4, :16] = -1
    return field


def see_depth(mesh, view):
    """Return the depth map of a mesh, NaN where the view sees nothing."""
    rays = (backproject_map(view, np.ones(CAMERA.shape)) - view.centre).reshape(-1, 3)  # of camera depth 1
    hits = RayCaster(mesh).first_hits(np.broadcast_to(view.centre, rays.shape).copy(), rays)
    return np.where(np.isfinite(hits.distance), hits.distance, np.nan).reshape(CAMERA.shape)


def confirm(field, sureness=0.0, trust=1.0, farther=0.0):
    """Return the depth that all views have of a solid, moved away from them by `farther`."""
    mesh = extract_surface(field, GRID)
    maps = {name: see_depth(mesh, view) + farther for name, view in VIEWS.items()}
    trusted = {name: np.full(CAMERA.shape, trust, np.float32) for name in VIEWS}
    votes = SoftMaximum(GRID, 4 * GRID.spacing, 10.0, distrust=5.0, discontinuity=0.1)
    return ConfirmedDepth(votes, 4 * GRID.spacing, sureness, 0.0, VIEWS, trusted, maps.__getitem__)
