"""Exact: transforms undo each other, projections hit what they should, grids lie where they say."""

from __future__ import annotations

import numpy as np
import pytest

from threedfs.geometry import grid, projection, rigid
from threedfs.geometry.lens import Lens
from threedfs.geometry.plane import fit_plane, propose_planes, score_planes
from threedfs.geometry.projection_matrix import decompose_projection
from threedfs.geometry.similarity import Similarity, align
from threedfs.types import Box, Camera, View

ROUNDING = 1e-12
"""A few operations on numbers of order one, in float64."""


@pytest.fixture
def random() -> np.random.Generator:
    """One fixed source of examples."""
    return np.random.default_rng(3)


@pytest.fixture
def view() -> View:
    """A camera of unequal focal lengths that looks at the origin from aside."""
    pose = rigid.look_at(np.array([1.0, -0.5, -3]), np.zeros(3), np.array([0.0, -1, 0]))
    return View("a", Camera(64, 48, 60.0, 55.0, 30.5, 24.0), pose)


def rotation_of(random) -> np.ndarray:
    """Draw a rotation."""
    q, r = np.linalg.qr(random.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q if np.linalg.det(q) > 0 else -q


def test_inverse_undoes_a_transform(random):
    transform = rigid.make_transform(rotation_of(random), random.normal(size=3))
    points = random.normal(size=(5, 4, 3))
    back = rigid.apply(rigid.invert(transform), rigid.apply(transform, points))
    assert np.abs(back - points).max() < ROUNDING


@pytest.mark.parametrize("angle", [0.0, 1e-3, 1.0, 3.0, np.pi])
def test_rotation_angle_is_the_angle(angle):
    c, s = np.cos(angle), np.sin(angle)
    rotation = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    # the arc cosine loses half the digits near 0 and pi
    assert rigid.rotation_angle(rotation) == pytest.approx(angle, abs=1e-7)


def test_camera_that_looks_at_a_point_sees_it_in_its_centre_upright(view):
    pixel, depth = projection.project(view, np.zeros(3))
    assert np.allclose(pixel, [view.camera.cx, view.camera.cy], atol=1e-10)
    assert depth == pytest.approx(np.linalg.norm([1.0, -0.5, -3]))
    above, _ = projection.project(view, np.array([0.0, -0.1, 0]))  # world up is -y here
    assert above[1] < pixel[1]  # rows grow downwards
    assert np.abs(view.centre - [1.0, -0.5, -3]).max() < ROUNDING


def test_backprojection_undoes_projection(view, random):
    points = random.uniform(-1, 1, (50, 3))
    pixels, depth = projection.project(view, points)
    assert np.abs(projection.backproject(view, pixels, depth) - points).max() < ROUNDING


def test_point_behind_the_camera_has_no_pixel(view):
    behind = view.centre * 2
    pixel, depth = projection.project(view, behind)
    assert depth < 0 and np.isnan(pixel).all()
    assert not projection.inside(view.camera, pixel)


def test_image_ends_at_the_centres_of_its_outermost_pixels(view):
    pixels = np.array([[0.0, 0], [63, 47], [-0.01, 0], [63.01, 0], [0, 47.01]])
    assert projection.inside(view.camera, pixels).tolist() == [True, True, False, False, False]


def test_depth_map_of_a_plane_has_its_points_and_normal(view):
    # the plane z = 1 of the world; depth along each ray follows from two dot products
    u, v = projection.pixel_grid(view.camera)
    rays = projection.backproject(view, np.stack([u, v], -1), np.ones_like(u)) - view.centre
    depth = (1 - view.centre[2]) / rays[..., 2]
    points = projection.backproject_map(view, depth)
    assert np.abs(points[..., 2] - 1).max() < 1e-10
    normals = projection.normals_from_depth(view.camera, depth)[1:-1, 1:-1]
    expected = view.cam_from_world[:3, :3] @ np.array([0.0, 0, -1])  # towards the camera
    assert np.abs(normals - expected).max() < 1e-9


def test_normals_of_any_depth_map_are_the_cross_products_of_its_differences(view, random):
    """Oracle: NumPy's gradient and cross product, where depth is rough, absent in places, and at the image's border."""
    depth = random.uniform(0.5, 2.0, view.camera.shape)
    depth[random.random(depth.shape) < 0.1] = np.nan
    u, v = projection.pixel_grid(view.camera)
    x, y = (u - view.camera.cx) / view.camera.fx, (v - view.camera.cy) / view.camera.fy
    points = np.stack([x * depth, y * depth, depth], axis=-1)
    expected = np.cross(np.gradient(points, axis=0), np.gradient(points, axis=1))
    expected /= np.linalg.norm(expected, axis=-1, keepdims=True)
    normals = projection.normals_from_depth(view.camera, depth)
    assert 0.3 < np.isfinite(normals[..., 0]).mean() < 0.9
    assert np.allclose(normals, expected, atol=1e-12, equal_nan=True)
    assert np.nanmax((normals * points).sum(-1)) < 0  # facing the camera
    with pytest.raises(ValueError, match="expected a depth map of"):
        projection.normals_from_depth(view.camera, depth[:-1])


def test_alignment_finds_the_similarity_that_made_the_points(random):
    true = Similarity(2.5, rotation_of(random), random.normal(size=3))
    source = random.normal(size=(20, 3))
    found = align(source, true.apply(source))
    assert found.scale == pytest.approx(true.scale)
    assert np.abs(found.rotation - true.rotation).max() < ROUNDING
    assert np.abs(found.translation - true.translation).max() < 10 * ROUNDING


def test_alignment_of_a_mirror_image_stays_a_rotation(random):
    source = random.normal(size=(20, 3))
    assert np.linalg.det(align(source, source * [1, 1, -1]).rotation) == pytest.approx(1)


def test_moved_camera_sees_the_moved_scene_in_the_same_place(view, random):
    similarity = Similarity(0.4, rotation_of(random), random.normal(size=3))
    points = random.uniform(-1, 1, (30, 3))
    moved = View("b", view.camera, similarity.apply_to_pose(view.cam_from_world))
    before, depth = projection.project(view, points)
    after, scaled = projection.project(moved, similarity.apply(points))
    assert np.abs(before - after).max() < 1e-9
    assert np.abs(scaled - 0.4 * depth).max() < ROUNDING


def test_grid_covers_its_box_from_face_to_face():
    low, high = np.array([0.0, 1, 2]), np.array([1.0, 1.5, 2.1])
    cover = grid.cover_box(Box(np.eye(3), low, high), 10)
    assert cover.shape == (10, 5, 1)
    assert cover.spacing == pytest.approx(0.1)
    faces = [(cover.axis(d)[0] - cover.spacing / 2, cover.axis(d)[-1] + cover.spacing / 2) for d in range(3)]
    assert np.allclose(faces, np.column_stack([low, high]))


def test_a_box_aslant_is_covered_by_the_voxels_of_its_grid(random):
    box = Box(rotation_of(random), np.array([-0.3, 0.2, 1.0]), np.array([0.7, 0.5, 1.2]))
    cover = grid.cover_box(box, 20)
    assert cover.shape == (20, 6, 4)
    points = random.uniform(box.low, box.high, (1000, 3)) @ box.axes
    assert box.contains(points).all() and grid.voxel_index(cover, points)[1].all()
    assert box.contains(grid.voxel_centres(cover)).all()


def test_box_aslant_contains_what_lies_between_its_faces(random):
    box = Box(rotation_of(random), np.array([-0.3, 0.2, 1.0]), np.array([0.7, 0.5, 1.2]))
    weights = random.dirichlet(np.ones(8), 500)
    assert box.contains(weights @ box.corners()).all() and box.contains(box.centre)
    outward = box.corners() - box.centre
    assert not box.contains(box.centre + 1.001 * outward).any()
    assert box.grow(0.01).contains(box.centre + 1.001 * outward).all()
    assert not box.contains(np.full(3, np.nan))
    assert box.longest == pytest.approx(1.0)


def test_homogeneous_indices_lead_to_the_centres_of_voxels(random):
    cover = grid.cover_box(Box(rotation_of(random), -np.ones(3), np.array([1.0, 0.7, 0.4])), 7)
    indices = np.stack(np.indices(cover.shape), -1).reshape(-1, 3)
    centres = grid.voxel_centres(cover).reshape(-1, 3)
    for found in (rigid.apply(cover.world_from_voxel, indices), grid.world_from_index(cover, indices)):
        assert np.abs(found - centres).max() < ROUNDING
    assert np.abs(grid.voxel_places(cover, np.arange(len(centres))) - centres).max() < ROUNDING
    assert np.abs(cover.axis(1)[3] - cover.axes[1] @ grid.voxel_centres(cover)[2, 3, 1]) < ROUNDING


def test_voxel_centres_are_whole_indices(random):
    cover = grid.cover_box(Box(rotation_of(random), np.zeros(3), np.array([1.0, 0.7, 0.4])), 7)
    centres = grid.voxel_centres(cover)
    assert centres.shape == (*cover.shape, 3)
    indices = np.stack(np.indices(cover.shape), -1)
    assert np.abs(grid.voxel_from_world(cover, centres) - indices).max() < ROUNDING * 10
    found, kept = grid.voxel_index(cover, centres.reshape(-1, 3))
    assert kept.all() and (found == indices.reshape(-1, 3)).all()


def test_points_outside_the_grid_are_left_out():
    cover = grid.cover_box(Box(np.eye(3), np.zeros(3), np.ones(3)), 4)
    found, kept = grid.voxel_index(cover, np.array([[0.01, 0.01, 0.99], [-0.01, 0.5, 0.5], [0.5, 1.01, 0.5]]))
    assert kept.tolist() == [True, False, False]
    assert found.tolist() == [[0, 0, 3]]


def test_lens_undoes_its_distortion(random):
    lens = Lens(Camera(640, 480, 600.0, 610.0, 319.0, 240.5), 0.12, -0.05)
    ideal = random.uniform(-0.4, 0.4, (100, 2))
    assert np.abs(lens.normalise(lens.denormalise(ideal)) - ideal).max() < 1e-10


def test_resized_lens_sees_the_same_place_of_the_image(random):
    lens = Lens(Camera(640, 480, 600.0, 610.0, 319.0, 240.5), 0.12, -0.05)
    ideal = random.uniform(-0.4, 0.4, (100, 2))
    half = lens.resize(320, 240).denormalise(ideal)
    assert np.abs((half + 0.5) * 2 - 0.5 - lens.denormalise(ideal)).max() < 1e-10


def test_projection_matrix_splits_into_what_made_it(view):
    for sign in (1, -3.5):
        intrinsics, pose = decompose_projection(sign * view.px_from_world)
        assert np.abs(intrinsics - view.camera.px_from_cam).max() < 1e-9
        assert np.abs(pose - view.cam_from_world).max() < ROUNDING * 10


@pytest.mark.parametrize("matrix", [np.zeros((3, 4)), np.full((3, 4), np.nan), np.ones((3, 4))])
def test_projection_matrix_without_a_camera_is_refused(matrix):
    with pytest.raises(ValueError, match=r"not finite|singular"):
        decompose_projection(matrix)


def test_plane_is_found_among_points_off_it(random):
    normal = np.array([0.6, 0.0, 0.8])
    on = random.uniform(-1, 1, (200, 3))
    on -= np.outer(on @ normal - 0.3, normal)
    points = np.concatenate([on, random.uniform(-1, 1, (100, 3))])
    plane = fit_plane(points, np.repeat([1.0, 0.0], [200, 100]))
    assert abs(abs(plane.normal @ normal) - 1) < ROUNDING and abs(abs(plane.offset) - 0.3) < ROUNDING
    weights = np.full(len(points), 1 / len(points))
    normals, offsets = propose_planes(points, weights, 200, random)
    scores = score_planes(normals, offsets, points, lambda _, distance: (np.abs(distance) < 1e-9).sum(1))
    best = np.argmax(scores)
    assert scores[best] == 200  # three points of 200 in 300: missed by all 200 draws with probability 1e-31
    assert abs(abs(normals[best] @ normal) - 1) < 1e-9
