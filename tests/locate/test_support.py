"""Property and rejection tests of the search for the support plane, the fixation point and the region."""

import numpy as np
import pytest

from threedfs.errors import UserError
from threedfs.geometry.grid import cover_box, voxel_centres
from threedfs.geometry.plane import fit_plane
from threedfs.geometry.rigid import look_at, make_transform
from threedfs.locate.fixation import find_fixation, find_up, viewing_distance
from threedfs.locate.region import scene_region
from threedfs.locate.support import SupportRule, find_support, settle_support
from threedfs.locate.surface import zero_crossings
from threedfs.types import Box, Camera, View

RULE = SupportRule(tolerance=0.015, doublings=3, reach=0.5, max_tilt=75.0, min_share=0.3, candidates=2000)
UP = np.array([0.0, 0, 1])
SIGNS = [(1, 1), (1, -1), (-1, 1), (-1, -1)]
CAMERA = Camera(160, 120, 150.0, 150.0, 79.5, 59.5)
ANGLES = 0.1 + 2 * np.pi * np.arange(12) / 12
ORBIT = [
    View("", CAMERA, look_at(np.array([1.2 * np.cos(a), 1.2 * np.sin(a), 0.9]), np.array([0, 0, 0.2]), UP))
    for a in ANGLES
]


def patch(rng, count, corner, across, down, normal, noise):
    s, t = rng.random((2, count, 1))
    points = np.array(corner) + s * across + t * down + rng.normal(0, noise, (count, 1)) * np.array(normal)
    return points, np.tile(np.array(normal, float), (count, 1))


def scene(noise=0.004, wall_points=30000):
    """A table top with a box on it, a wall behind with far more points, and the floor below the table."""
    rng = np.random.default_rng(1)
    patches = [
        patch(rng, 6000, (-0.6, -0.6, 0), (1.2, 0, 0), (0, 1.2, 0), (0, 0, 1), noise),
        patch(rng, 2000, (-0.15, -0.15, 0.2), (0.3, 0, 0), (0, 0.3, 0), (0, 0, 1), noise),
        patch(rng, 1000, (-0.15, -0.15, 0), (0.3, 0, 0), (0, 0, 0.2), (0, -1, 0), noise),
        patch(rng, wall_points, (-2, 0.8, -0.7), (4, 0, 0), (0, 0, 2.5), (0, -1, 0), noise),
        patch(rng, 6000, (-2, -2, -0.7), (4, 0, 0), (0, 2.8, 0), (0, 0, 1), noise),
    ]
    points, normals = (np.concatenate(part) for part in zip(*patches, strict=True))
    angles = np.linspace(-2.6, -0.5, 15)  # an arc in front of the wall
    centres = np.stack([1.2 * np.cos(angles), 1.2 * np.sin(angles), np.full(15, 0.8)], axis=1)
    return points, normals, centres


NONE = np.empty((0, 3))


def search(surface, normals, centres, rule=RULE, up=UP, points=NONE):
    return find_support(surface, normals, points, centres, np.array([0, 0, 0.1]), up, rule, np.random.default_rng(0))


def test_table_is_found_beside_a_dominant_wall():
    """Property: neither the wall, nor the floor, nor the box's top, though the guess of up is 35 degrees off."""
    tilted = np.array([0, -np.sin(np.radians(35)), np.cos(np.radians(35))])
    found = search(*scene(), up=tilted)
    assert np.degrees(np.arccos(found.plane.normal @ UP)) < 0.5
    assert abs(found.plane.offset) < 0.003  # under the noise of single points, 0.004
    assert found.noise == pytest.approx(0.004, rel=0.2)


def test_motion_of_the_world_moves_the_plane_with_it():
    """Property: the same plane in other coordinates, up to rounding."""
    points, normals, centres = scene()
    rotation = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    rotation *= np.sign(np.linalg.det(rotation))
    move = make_transform(rotation, [0.3, -2.0, 1.0])
    there = find_support(
        points @ rotation.T + move[:3, 3],
        normals @ rotation.T,
        NONE,
        centres @ rotation.T + move[:3, 3],
        rotation @ [0, 0, 0.1] + move[:3, 3],
        rotation @ UP,
        RULE,
        np.random.default_rng(0),
    )
    here = search(points, normals, centres)
    np.testing.assert_allclose(there.plane.normal, rotation @ here.plane.normal, atol=1e-6)
    assert there.share == pytest.approx(here.share)


def test_same_seed_same_plane():
    """Exact."""
    one, two = search(*scene()), search(*scene())
    assert one.plane.normal.tobytes() == two.plane.normal.tobytes()


def test_rough_surface_is_found_at_a_wider_tolerance():
    """Property: with noise of four tolerances the plane is still found, and its noise told."""
    found = search(*scene(noise=0.06))
    assert np.degrees(np.arccos(found.plane.normal @ UP)) < 6
    assert abs(found.plane.offset) < 0.06
    assert found.noise > 0.02


def settle(found, heights):
    rng = np.random.default_rng(2)
    points = np.column_stack([rng.uniform(-0.6, 0.6, (len(heights), 2)), heights])
    return settle_support(found, points, scene()[2], np.array([0, 0, 0.1]), UP, RULE, np.random.default_rng(0))


def test_sunk_surface_is_lifted_onto_the_points():
    """Property: a rough surface that the soft maximum sank gives way to points that agree on the floor."""
    points, normals, centres = scene(noise=0.03)
    sunk = search(points - 0.08 * UP, normals, centres)
    rng = np.random.default_rng(0)
    settled = settle(sunk, np.concatenate([rng.normal(0, 0.005, 2000), rng.uniform(0, 0.3, 500)]))
    assert abs(settled.plane.offset) < 0.002  # 0.005 over the root of 2000 points, and the object's few beside
    assert settled.noise < sunk.noise


@pytest.mark.parametrize("heights", [np.zeros(20), np.random.default_rng(0).uniform(-0.2, 0.2, 3000)])
def test_few_or_scattered_points_move_nothing(heights):
    """Property: a plane found sharply in the surface stays."""
    found = search(*scene(noise=0.002))
    assert settle(found, heights) is found


def test_points_tell_the_plane_where_the_surface_has_none():
    """Property: a shattered surface leaves the plane to the points measured on the table and the object."""
    rng = np.random.default_rng(0)
    direction = rng.normal(size=(5000, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    table_points = np.column_stack([rng.uniform(-0.6, 0.6, (3000, 2)), rng.normal(0, 0.005, 3000)])
    object_points = np.array([0, 0, 0.15]) + rng.uniform(-0.15, 0.15, (3000, 3))
    found = search(0.8 * direction, direction, scene()[2], points=np.concatenate([table_points, object_points]))
    assert found.plane.normal @ UP > np.cos(np.radians(0.5))
    assert abs(found.plane.offset) < 0.005


def test_sharp_points_are_believed_over_a_rough_surface():
    """Property: fused from uncertain depth, the surface sinks aslant under the table; the points lie on the table."""
    rng = np.random.default_rng(4)
    slanted = np.array([0.3, 0.3, 0.9]) / np.linalg.norm([0.3, 0.3, 0.9])
    surface, normals = patch(rng, 3000, (-0.4, -0.4, -0.05), (0.8, 0, -0.27), (0, 0.8, -0.27), slanted, 0.04)
    table, _ = patch(rng, 1000, (-0.4, -0.4, 0), (0.8, 0, 0), (0, 0.8, 0), (0, 0, 1), 0.003)
    on_object = rng.uniform((-0.1, -0.1, 0.02), (0.1, 0.1, 0.3), (2000, 3))
    centres = scene()[2]
    found = search(surface, normals, centres, points=np.concatenate([table, on_object]))
    assert np.degrees(np.arccos(found.plane.normal @ UP)) < 0.5
    assert abs(found.plane.offset) < 0.003


def test_no_plane_is_told():
    """Rejection: points in a ball have no plane."""
    rng = np.random.default_rng(0)
    direction = rng.normal(size=(5000, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    with pytest.raises(UserError, match="No support plane was found"):
        search(0.8 * direction, direction, scene()[2])


def test_only_a_wall_is_no_support():
    """Rejection: nothing faces upward."""
    points, normals, centres = scene()
    wall = normals[:, 1] < 0
    with pytest.raises(UserError, match="No support plane was found"):
        search(points[wall], normals[wall], centres)


def test_least_squares_plane_is_exact():
    """Exact: points on a plane give it back."""
    normal = np.array([1.0, 2, 2]) / 3
    rng = np.random.default_rng(0)
    points = rng.normal(size=(50, 3))
    points -= ((points @ normal) - 0.7)[:, None] * normal
    plane = fit_plane(points)
    assert abs(plane.normal @ normal) == pytest.approx(1, abs=1e-12)
    np.testing.assert_allclose(plane.distance(points), 0, atol=1e-12)


def test_zero_crossings_lie_on_the_surface_and_not_beside_unseen_space():
    """Exact: of a linear field, its plane; the border of unseen voxels is none."""
    grid = cover_box(Box(np.eye(3), np.zeros(3), np.ones(3)), 10)
    sdf = (voxel_centres(grid) @ UP - 0.52).astype(np.float32)
    seen = np.ones(grid.shape, np.uint8)
    seen[:5] = 0
    points, normals = zero_crossings(grid, np.where(seen > 0, sdf, 1), seen)
    np.testing.assert_allclose(points[:, 2], 0.52, atol=1e-6)
    assert points[:, 0].min() > 0.5
    inner = points[:, 0] > 0.6
    np.testing.assert_allclose(normals[inner], np.tile(UP, (inner.sum(), 1)), atol=1e-6)


def test_fixation_is_where_the_axes_meet():
    """Exact: every view looks at (0, 0, 0.2); a far centre of one percent of a view moves it little."""
    fixation = find_fixation(ORBIT, np.array([0.0, 0.0, 0.1]))
    np.testing.assert_allclose(fixation, [0, 0, 0.2], atol=0.003)
    assert viewing_distance(ORBIT, fixation) == pytest.approx(np.hypot(1.2, 0.7), rel=0.01)


@pytest.mark.parametrize("quarter_turns", [0, 1, 2, 3])
def test_up_is_found_however_the_phone_was_held(quarter_turns):
    """Property: rolling every camera about its axis by quarter turns leaves up where it is."""
    angle = quarter_turns * np.pi / 2
    c, s = np.round([np.cos(angle), np.sin(angle)])
    roll = make_transform(np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]), np.zeros(3))
    views = [View(view.name, view.camera, roll @ view.cam_from_world) for view in ORBIT]
    assert find_up(views, np.array([0, 0, 0.2])) @ UP > 0.99


def test_region_is_the_papers_within_limits():
    """Exact: median plus and minus two deviations, but not farther nor nearer than the reaches."""
    points = np.random.default_rng(0).normal([1, 2, 3], [0.01, 0.2, 0.5], (1000, 3))
    region = scene_region(points, 2.0, np.array([1.0, 2, 3]), least_reach=0.1, reach=0.6)
    low, high = region.low, region.high
    centre, spread = np.median(points, axis=0), points.std(axis=0)
    np.testing.assert_allclose([low[0], high[0]], [0.9, 1.1])
    np.testing.assert_allclose([low[1], high[1]], [centre[1] - 2 * spread[1], centre[1] + 2 * spread[1]])
    np.testing.assert_allclose([low[2], high[2]], [2.4, 3.6])


@pytest.mark.parametrize(
    ("points", "sentence"), [(np.zeros((2, 3)), "span no volume"), (np.eye(3).repeat(3, 0) + 50, "do not look")]
)
def test_region_rejects(points, sentence):
    """Rejection."""
    with pytest.raises(UserError, match=sentence):
        scene_region(points, 2.0, np.zeros(3), 0.5, 1.0)


@pytest.mark.parametrize("height", [0.9, 3.0, 12.0, 400.0])
def test_up_is_found_on_steep_paths(height):
    """Property: an orbit however steep, down to one straight above in which no axis has a common part."""
    angles = 2 * np.pi * np.arange(12) / 12
    centres = np.stack([1.2 * np.cos(angles), 1.2 * np.sin(angles), np.full(12, height)], axis=1)
    views = [View("", CAMERA, look_at(centre, np.array([0, 0, 0.2]), UP)) for centre in centres]
    assert find_up(views, np.array([0, 0, 0.2])) @ UP > 0.99


def test_views_from_all_around_do_not_tell_up():
    """Rejection: opposite cameras, each once upright and once upside down: nothing has a common part."""
    poses = [(side * np.eye(3)[axis], turn * np.eye(3)[axis - 1]) for axis in range(3) for side, turn in SIGNS]
    views = [View("", CAMERA, look_at(centre, np.zeros(3), up)) for centre, up in poses]
    with pytest.raises(UserError, match="do not tell which way is up"):
        find_up(views, np.zeros(3))
