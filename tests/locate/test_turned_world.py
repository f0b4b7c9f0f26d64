"""Property: turning cameras, points and plane, and the grid with them, leaves all that is on the grid as it was."""

from dataclasses import replace

import numpy as np
import pytest

from threedfs.deform.correction import CorrectionRule, correct_zero_crossing
from threedfs.deform.evidence import average_in_cells, measure_scatter, sample_field, sample_gradient, take_points
from threedfs.fusion.hard_maximum import HardMaximum
from threedfs.fusion.softmax import SoftMaximum
from threedfs.fusion.weighted_average import WeightedAverage
from threedfs.geometry.grid import cover_box, voxel_centres
from threedfs.geometry.projection import backproject_map
from threedfs.geometry.rigid import apply, invert, look_at, make_transform
from threedfs.hull.gaps import fit_masks
from threedfs.locate.component import choose_component, mark_points
from threedfs.locate.height import add_foot, height_above
from threedfs.locate.surface import zero_crossings
from threedfs.object.extract import extract_surface
from threedfs.segment.outline import draw_voxels
from threedfs.segment.table import picture_table
from threedfs.stereo.region import mask_box
from threedfs.types import Box, Camera, OrientedPoints, Plane, View, VoxelGrid

TURN = look_at(np.array([0.4, -0.9, 0.7]), np.array([0.1, 0.3, -0.2]), np.array([0.2, 0.1, 1.0]))
"""New world from world."""
BOX = Box(np.eye(3), np.array([-0.35, -0.3, -0.05]), np.array([0.35, 0.3, 0.55]))
TABLE = Plane(np.array([0.0, 0, 1]), 0.0)
CENTRE, RADIUS = np.array([0.03, -0.02, 0.26]), 0.23
CAMERA = Camera(160, 120, 150.0, 150.0, 79.5, 59.5)
VIEWS = [
    View(
        str(n), CAMERA, look_at(np.array([1.2 * np.cos(a), 1.2 * np.sin(a), 0.9]), np.array([0, 0, 0.2]), TABLE.normal)
    )
    for n, a in enumerate(0.1 + 2 * np.pi * np.arange(6) / 6)
]


def turn_box(box: Box) -> Box:
    axes = box.axes @ TURN[:3, :3].T
    return Box(axes, box.low + axes @ TURN[:3, 3], box.high + axes @ TURN[:3, 3])


def turn_plane(plane: Plane) -> Plane:
    normal = TURN[:3, :3] @ plane.normal
    return Plane(normal, plane.offset - normal @ TURN[:3, 3])


def turn_view(view: View) -> View:
    return replace(view, cam_from_world=view.cam_from_world @ invert(TURN))


def depth_of(view: View) -> np.ndarray:
    """Depth of a ball over a table, in closed form."""
    rays = backproject_map(view, np.ones(view.camera.shape)) - view.centre
    toward = view.centre - CENTRE
    a, b, c = (rays**2).sum(-1), rays @ toward, toward @ toward - RADIUS**2
    ball = np.where(b**2 > a * c, (-b - np.sqrt(np.maximum(b**2 - a * c, 0))) / a, np.inf)
    with np.errstate(divide="ignore"):
        table = -view.centre[2] / rays[..., 2]
    return np.minimum(ball, np.where(table > 0, table, np.inf))


GRID, TURNED = cover_box(BOX, 40), cover_box(turn_box(BOX), 40)
DISTANCE = np.linalg.norm(voxel_centres(GRID) - CENTRE, axis=-1) - RADIUS
SDF = np.clip(DISTANCE / (5 * GRID.spacing), -1, 1).astype(np.float32)
SEEN = np.ones(GRID.shape, np.uint8)


def test_the_grid_turns_with_its_box():
    """Exact."""
    assert TURNED.shape == GRID.shape
    np.testing.assert_allclose(voxel_centres(TURNED), apply(TURN, voxel_centres(GRID)), atol=1e-12)


@pytest.mark.parametrize("kind", ["soft", "hard", "average"])
def test_fused_field(kind):
    """Rounding takes a voxel on a pixel's border to the next pixel here and there."""

    def fuse(grid: VoxelGrid, views: list[View]) -> np.ndarray:
        settings = {"discontinuity": 0.02}
        fused = {
            "soft": lambda: SoftMaximum(grid, 0.06, 10.0, distrust=0.0, **settings),
            "hard": lambda: HardMaximum(grid, 0.06, **settings),
            "average": lambda: WeightedAverage(grid, 0.06, **settings),
        }[kind]()
        for view, own in zip(views, VIEWS, strict=True):
            fused.add(view, depth_of(own))
        return fused.result()[0]

    before, after = fuse(GRID, VIEWS), fuse(TURNED, [turn_view(view) for view in VIEWS])
    assert (before < 0).any()
    assert np.isclose(before, after, atol=1e-4).mean() > 0.999


def test_component_height_and_foot():
    """Exact: the same voxels, and heights to single precision."""

    def find(grid, plane, points, fixation):
        height, holds = height_above(plane, grid), np.zeros(grid.shape, bool)
        mark_points(grid, points, holds)
        chosen = choose_component((SDF < 0) & (height > 0.06), grid, holds, fixation, reach=0.3)
        return height, chosen, add_foot(chosen.voxels, height, grid, plane, 0.06)

    points = CENTRE + RADIUS * np.random.default_rng(0).normal(size=(500, 3)) / 2
    height, chosen, owned = find(GRID, TABLE, points, CENTRE)
    turned_height, turned, turned_owned = find(TURNED, turn_plane(TABLE), apply(TURN, points), apply(TURN, CENTRE))
    np.testing.assert_allclose(turned_height, height, atol=1e-6)
    assert np.ptp(turned_height, axis=(0, 1)).max() < 1e-6, "the grid stands on the plane"
    assert chosen.support == turned.support > 100
    np.testing.assert_array_equal(turned.voxels, chosen.voxels)
    np.testing.assert_array_equal(turned_owned, owned)
    assert owned.sum() > chosen.voxels.sum()


def test_zero_level_and_its_normals():
    """Exact: points and normals turn with the world; the normals point out of the ball."""
    points, normals = zero_crossings(GRID, SDF, SEEN)
    turned_points, turned_normals = zero_crossings(TURNED, SDF, SEEN)
    np.testing.assert_allclose(turned_points, apply(TURN, points), atol=1e-9)
    np.testing.assert_allclose(turned_normals, normals @ TURN[:3, :3].T, atol=1e-9)
    outward = turned_points - apply(TURN, CENTRE)
    assert ((outward * turned_normals).sum(axis=1) > 0.98 * np.linalg.norm(outward, axis=1)).all()


def test_mesh_and_silhouettes():
    """Exact: vertices turn with the world; the same outlines but for pixels on an edge."""
    mesh, turned = extract_surface(SDF, GRID), extract_surface(SDF, TURNED)
    np.testing.assert_allclose(turned.vertices, apply(TURN, mesh.vertices), atol=1e-9)
    np.testing.assert_array_equal(turned.faces, mesh.faces)
    drawn = draw_voxels(SDF < 0, GRID, {view.name: view for view in VIEWS})
    again = draw_voxels(SDF < 0, TURNED, {view.name: turn_view(view) for view in VIEWS})
    for name, mask in drawn.items():
        assert mask.any() and (mask != again[name]).sum() <= 3


def test_field_fitted_to_masks():
    """Exact but for voxels on a pixel's border."""
    views = {view.name: view for view in VIEWS}
    masks = draw_voxels(DISTANCE < -0.02, GRID, views)
    height = height_above(TABLE, GRID)

    def fit(grid, views):
        valid = dict.fromkeys(views, np.ones(CAMERA.shape, bool))
        return fit_masks(SDF, SDF < 0, height > 0, masks, views, valid, grid, ramp=5, tolerance=0.1, least_views=2)[0]

    before, after = fit(GRID, views), fit(TURNED, {name: turn_view(view) for name, view in views.items()})
    assert (before != SDF).any()
    assert np.isclose(before, after, atol=1e-3).mean() > 0.995


def test_corrected_field():
    """Exact to the functions left out far away: with the same draws the same correction, of points with normals."""
    out = np.random.default_rng(1).normal(size=(4000, 3))
    out /= np.linalg.norm(out, axis=1, keepdims=True)
    pairs = np.repeat(np.arange(4000), 4), np.tile(np.arange(4), 4000)
    xyz = CENTRE + (RADIUS + GRID.spacing) * out
    rule = CorrectionRule(0.12, 600, 0.5, 2000, 100, 1.0, 2, 0.1)

    def correct(grid, xyz, normal):
        points = OrientedPoints(xyz, normal.astype(np.float32), np.zeros((4000, 3), np.uint8), *pairs)
        samples = take_points(points, SDF, SEEN, grid, reach=0.9, min_cosine=0.5, full_sightings=4)
        assert len(samples.xyz) > 3500
        np.testing.assert_allclose((sample_gradient(SDF, grid, xyz) * normal).sum(axis=1), 1, atol=0.02)
        scatter = measure_scatter(samples, SDF, grid)
        cells = average_in_cells(samples, grid, 1.5)
        return scatter, correct_zero_crossing(SDF, SEEN, grid, cells, rule, np.random.default_rng(0))

    scatter, before = correct(GRID, xyz, out)
    turned_scatter, after = correct(TURNED, apply(TURN, xyz), out @ TURN[:3, :3].T)
    assert turned_scatter == pytest.approx(scatter)
    np.testing.assert_allclose(after, before, atol=1e-4)
    assert np.abs(sample_field(after, TURNED, apply(TURN, xyz))).max() < 0.1 < np.abs(before - SDF).max()


def test_picture_of_the_table_and_pixels_of_the_box():
    """The picture lies along the box: the same colours; the same pixels see the box, but for those on its outline."""
    rng = np.random.default_rng(2)
    images = {view.name: rng.integers(0, 255, (*CAMERA.shape, 3)).astype(np.uint8) for view in VIEWS}
    clear = np.zeros(CAMERA.shape, bool)
    solid = voxel_centres(GRID)[SDF < 0]

    def picture(views, plane, solid, box):
        named = {view.name: view for view in views}
        return picture_table(
            images, named, dict.fromkeys(images, clear), dict.fromkeys(images, ~clear), plane, solid, box
        )

    wide, turned = BOX.grow(0.2), [turn_view(view) for view in VIEWS]
    before = picture(VIEWS, TABLE, solid, wide)
    after = picture(turned, turn_plane(TABLE), apply(TURN, solid), turn_box(wide))
    assert before.color.shape == after.color.shape and before.beneath.any()
    assert np.isclose(before.color, after.color, atol=1).mean() > 0.98
    assert (before.beneath != after.beneath).mean() < 0.01
    for view, own in zip(turned, VIEWS, strict=True):
        assert (mask_box(view, turn_box(BOX)) != mask_box(own, BOX)).sum() <= 3


def test_turn_is_a_turn():
    """The tests above would hold for anything if it were none."""
    np.testing.assert_allclose(TURN[:3, :3] @ TURN[:3, :3].T, np.eye(3), atol=1e-12)
    assert np.abs(make_transform(np.eye(3), np.zeros(3)) - TURN)[:3, :3].max() > 0.5
