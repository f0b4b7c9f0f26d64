"""Exact and property tests of the soft maximum of signed distances."""

import numpy as np
import pytest

from threedfs.errors import UserError
from threedfs.fusion.fuse import limit_clip_distance
from threedfs.fusion.softmax import SoftMaximum
from threedfs.geometry.grid import cover_box, voxel_centres
from threedfs.geometry.rigid import invert, look_at, make_transform
from threedfs.types import Box, Camera, View, VoxelGrid

FACING = View("a", Camera(81, 81, 100.0, 100.0, 40.0, 40.0), np.eye(4))


def fuse(grid, votes, *, clip=0.1, hardness=10.0, distrust=40.0, **settings):
    fused = SoftMaximum(grid, clip, hardness, distrust=distrust, discontinuity=0.02, **settings)
    for vote in votes:
        fused.add(*vote)
    return fused.result()


def height_errors(scene, grid, views, radius_share, **settings):
    """Height of the zero level over the sphere's top, less the true one, in voxels."""
    sdf, _ = fuse(grid, [(view, scene.depth(view)) for view in views], **settings)
    axis = grid.axis(2)
    errors = []
    for ix, iy in np.ndindex(sdf.shape[:2]):
        x, y = grid.axis(0)[ix], grid.axis(1)[iy]
        if np.hypot(x, y) < radius_share * scene.radius:
            top = np.flatnonzero(sdf[ix, iy] < 0).max()
            a, b = sdf[ix, iy, top], sdf[ix, iy, top + 1]
            height = axis[top] + grid.spacing * a / (a - b)
            errors.append((height - scene.radius - np.sqrt(scene.radius**2 - x**2 - y**2)) / grid.spacing)
    return np.array(errors)


def test_single_view_is_the_distance_along_the_ray():
    """Oracle: for one plane seen head on, Eq. 14 has a closed form."""
    grid = VoxelGrid(np.array([-0.2, -0.1, 0.9]), 0.02, (21, 11, 11))
    sdf, seen = fuse(grid, [(FACING, np.full((81, 81), 1.0))], clip=0.05)
    centres = voxel_centres(grid)
    ray = np.linalg.norm(centres / centres[..., 2:], axis=-1)
    expected = np.clip((1.0 - centres[..., 2]) * ray / 0.05, -1, 1)
    np.testing.assert_allclose(sdf, expected, atol=1e-5)  # float32 inverse depth
    assert (seen == 1).all()


TOP = cover_box(Box(np.eye(3), np.array([-0.3, -0.3, 0.1]), np.array([0.3, 0.3, 0.6])), 60)


def test_zero_level_of_a_view_from_above_is_exact(table):
    """Convergence: with exact depth seen head on, the zero level is the surface to a small part of a voxel."""
    above = View("top", table.views[0].camera, look_at(np.array([0, 0, 1.2]), np.zeros(3), np.array([0.0, 1, 0])))
    errors = height_errors(table, TOP, [above], 0.5, clip=0.04)
    assert np.abs(errors).max() < 0.1  # bilinear depth on 0.7 voxels per pixel


@pytest.mark.parametrize("hardness", [10.0, 60.0])
def test_zero_level_of_many_views_lies_within_a_voxel(table, hardness):
    """Property: views that graze the surface see the voxel outside it as fully empty, the one inside as barely solid.

    So a maximum bends the zero level inward, by less than the voxel between them and half a pixel (0.45 voxels).
    """
    errors = height_errors(table, TOP, table.views, 0.6, clip=0.04, hardness=hardness)
    assert errors.max() < 0.1
    assert errors.min() > -1.45
    assert -0.5 < np.median(errors) <= 0


@pytest.mark.parametrize("hardness", [0.0, 1.0, 10.0, 60.0])
def test_between_least_and_largest_vote(hardness):
    """Property: a soft maximum lies between the mean and the maximum, and 0 gives the mean."""
    grid = VoxelGrid(np.array([0.0, 0.0, 0.95]), 0.01, (1, 1, 10))
    depths = [0.97, 1.0, 1.02]
    votes = [(FACING, np.full((81, 81), depth)) for depth in depths]
    sdf, seen = fuse(grid, votes, clip=0.05, hardness=hardness)
    single = np.stack([fuse(grid, [vote], clip=0.05)[0] for vote in votes])
    assert (sdf <= single.max(axis=0) + 1e-6).all()
    assert (sdf >= single.mean(axis=0) - 1e-6).all()
    if hardness == 0:
        np.testing.assert_allclose(sdf, single.mean(axis=0), atol=1e-6)
    assert (seen == 3).all()


def test_unseen_is_neither_empty_nor_solid():
    """Exact: behind the camera, outside the image and without depth nobody votes."""
    grid = VoxelGrid(np.array([-0.5, 0.0, -1.0]), 0.5, (3, 1, 5))
    depth = np.full((81, 81), 1.0)
    depth[:, 40:] = np.nan
    sdf, seen = fuse(grid, [(FACING, depth)], clip=0.1)
    assert (seen[:, :, :3] == 0).all(), "behind the camera or at its centre"
    assert (seen[1, 0, 3:] == 0).all(), "on a pixel without depth"
    assert (seen[2] == 0).all()
    assert seen[0, 0, 3] == 0, "outside the image"
    assert (sdf[seen == 0] == 1).all()


def test_unseen_needs_no_neighbour():
    """Exact: one NaN pixel silences its own voxel only."""
    grid = VoxelGrid(np.array([-0.1, 0.0, 1.0]), 0.01, (21, 1, 1))
    depth = np.full((81, 81), 1.05)
    depth[40, 40] = np.nan
    _, seen = fuse(grid, [(FACING, depth)])
    assert np.flatnonzero(seen[:, 0, 0] == 0).tolist() == [10]


def test_moving_the_world_changes_nothing(table):
    """Property: a rigid motion by whole quarter turns maps the grid onto itself, and so the field."""
    turn = make_transform(np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]), [0.3, -0.2, 0.7])
    grid = cover_box(Box(np.eye(3), np.array([-0.4, -0.4, -0.1]), np.array([0.4, 0.4, 0.6])), 40)
    corner = turn[:3, :3] @ (grid.origin + grid.spacing * np.array([0, grid.shape[1] - 1, 0])) + turn[:3, 3]
    turned = VoxelGrid(corner, grid.spacing, grid.shape)
    votes = [(view, table.depth(view)) for view in table.views[:3]]
    moved = [(View(view.name, view.camera, view.cam_from_world @ invert(turn)), depth) for view, depth in votes]
    sdf, _ = fuse(grid, votes)
    sdf_moved, _ = fuse(turned, moved)
    same = np.isclose(sdf_moved, np.rot90(sdf, 1, axes=(0, 1)), atol=1e-3)
    assert same.mean() > 0.999  # rounding takes a voxel on a pixel's border to the next pixel here and there


def test_threads_do_not_change_a_bit(table):
    """Exact: voxels are independent."""
    grid = cover_box(Box(np.eye(3), np.array([-0.4, -0.4, -0.1]), np.array([0.4, 0.4, 0.6])), 40)
    votes = [(view, table.depth(view)) for view in table.views[:4]]
    one, two = fuse(grid, votes, threads=1), fuse(grid, votes, threads=2)
    assert one[0].tobytes() == two[0].tobytes()
    assert one[1].tobytes() == two[1].tobytes()


def test_no_surface_across_a_depth_discontinuity():
    """Exact: halfway between a near and a far pixel the field knows one of the two, never a depth between."""
    depth = np.full((81, 81), 2.0)
    depth[:, :41] = 1.0
    grid = VoxelGrid(np.array([0.0045 * 1.4, 0.0, 1.4]), 0.01, (1, 1, 20))
    sdf, _ = fuse(grid, [(FACING, depth)], clip=0.05)
    assert (sdf == -1).all()  # u = 40.45: the near pixel, whose surface lies 8 clip distances in front


def test_distrusted_vote_loses_but_decides_alone():
    """Exact: a handicap only matters against others."""
    grid = VoxelGrid(np.array([0.0, 0.0, 1.5]), 0.01, (1, 1, 1))
    shape = (81, 81)
    empty = (FACING, np.full(shape, 2.0), np.zeros(shape))
    solid = (FACING, np.full(shape, 1.0), np.ones(shape))
    assert fuse(grid, [empty])[0].item() == 1
    assert fuse(grid, [empty, solid])[0].item() == pytest.approx(-1, abs=1e-6)
    assert fuse(grid, [empty[:2], solid[:2]])[0].item() == pytest.approx(1, abs=1e-6)
    # Nothing contradicts that the ray is free up to 1.6, so there the vote counts whatever the pixel's trust.
    assert fuse(grid, [(*empty, np.full(shape, 1.6)), solid])[0].item() == pytest.approx(1, abs=1e-6)


def test_space_before_a_distrusted_surface_counts_by_the_confidence_in_that():
    """Exact: two views, one surface behind the other; in front of both, between them, and behind both."""
    grid = VoxelGrid(np.array([0.0, 0.0, 0.8]), 0.1, (1, 1, 8))
    near, far, whole, none = (np.full((81, 81), value) for value in (1.05, 1.25, 1.0, 0.0))
    votes = [(FACING, near, whole * 0.5), (FACING, far, none, None, whole)]
    sdf = fuse(grid, votes, clip=0.01, hardness=0.0)[0][0, 0]
    np.testing.assert_allclose(sdf, [1, 1, 1, 1, 1, -1, -1, -1], atol=1e-6)
    sdf = fuse(grid, [votes[0], votes[1][:3]], clip=0.01, hardness=0.0)[0][0, 0]
    np.testing.assert_allclose(sdf, [1, 1, 1, -1, -1, -1, -1, -1], atol=1e-6)


def test_confidence_above_1_makes_up_for_a_surface_that_turns_away():
    """Exact: seen at a cosine of about 0.7, twice the confidence counts as a full one that is seen squarely."""
    grid = VoxelGrid(np.array([0.0, 0.0, 0.8]), 0.1, (1, 1, 8))
    aslant = 1 / (1 + (np.arange(81) - 40) / 100) * np.ones((81, 1))
    other = (FACING, np.full((81, 81), 1.25), np.full((81, 81), 0.5))

    def votes(confidence):
        return [(FACING, aslant, np.full((81, 81), confidence)), other]

    plain = fuse(grid, votes(1.0), clip=0.01, hardness=0.0, facing=0.0)[0]
    assert fuse(grid, votes(2.0), clip=0.01, hardness=0.0, facing=1.0)[0].tobytes() == plain.tobytes()
    assert fuse(grid, votes(1.0), clip=0.01, hardness=0.0, facing=1.0)[0].tobytes() != plain.tobytes()


def test_view_that_does_not_see_a_voxel_is_not_heard_where_another_sees_it():
    """Exact: hidden votes count only among themselves, and without confidence as in the paper."""
    grid = VoxelGrid(np.array([0.0, 0.0, 1.5]), 0.01, (1, 1, 1))
    trusted = np.ones((81, 81))
    seeing = (FACING, np.full((81, 81), 1.55), trusted)
    hiding = (FACING, np.full((81, 81), 1.3), trusted)
    settings = {"hardness": 0.0, "hidden": 30.0}
    assert fuse(grid, [seeing, hiding], **settings)[0].item() == pytest.approx(0.5, abs=1e-5)
    assert fuse(grid, [hiding], **settings)[0].item() == -1
    assert fuse(grid, [seeing[:2], hiding[:2]], **settings)[0].item() == pytest.approx(-0.25, abs=1e-5)
    nearer = (FACING, np.full((81, 81), 1.45), trusted)  # half a clip distance behind it is still seen
    assert fuse(grid, [seeing, nearer], **settings)[0].item() == pytest.approx(0.0, abs=1e-5)


def test_handicap_of_hidden_votes_grows_with_the_distance_behind_the_surface():
    """Exact: none up to hidden_distance, all at the clip distance, in proportion between."""
    grid = VoxelGrid(np.array([0.0, 0.0, 1.5]), 0.01, (1, 1, 1))
    seeing = (FACING, np.full((81, 81), 1.55), np.ones((81, 81)))
    for depth, hidden_distance, share in ((1.45, 0.02, 3 / 8), (1.45, 0.05, 0.0), (1.42, 0.0, 0.8), (1.38, 0.0, 1.0)):
        behind = (FACING, np.full((81, 81), depth), np.ones((81, 81)))
        vote = np.exp(-4.0 * share)
        expected = (0.5 + vote * max(-1.0, (depth - 1.5) / 0.1)) / (1 + vote)
        found = fuse(grid, [seeing, behind], hardness=0.0, hidden=4.0, hidden_distance=hidden_distance)[0].item()
        assert found == pytest.approx(expected, abs=1e-5)


def test_rejects_maps_of_another_size():
    """Rejection."""
    grid = VoxelGrid(np.zeros(3), 1.0, (1, 1, 1))
    with pytest.raises(UserError, match="depth of view a"):
        fuse(grid, [(FACING, np.ones((80, 81)))])


def test_view_looking_away_sees_nothing():
    """Exact."""
    away = View("b", FACING.camera, look_at(np.array([0, 0, -2.0]), np.array([0, 0, -5.0]), np.array([0.0, 1, 0])))
    _, seen = fuse(VoxelGrid(np.zeros(3), 0.1, (3, 3, 3)), [(away, np.full((81, 81), 9.0))])
    assert not seen.any()


def test_without_confidence_every_vote_counts_the_same(table):
    """Exact: plain votes are the paper's, whatever is set for those weighed by confidence."""
    grid = cover_box(Box(np.eye(3), np.array([-0.4, -0.4, -0.1]), np.array([0.4, 0.4, 0.6])), 30)
    votes = [(view, table.depth(view)) for view in table.views[:4]]
    sure = [(*vote, np.ones(vote[1].shape)) for vote in votes]
    plain = fuse(grid, votes)[0]
    assert fuse(grid, votes, facing=1.0, trust_blur=4.0)[0].tobytes() == plain.tobytes()
    assert fuse(grid, sure)[0].tobytes() == plain.tobytes()
    assert not np.array_equal(fuse(grid, sure, facing=1.0, trust_blur=4.0)[0], plain)


@pytest.mark.parametrize(
    ("share", "thickness", "expected"), [(0.25, 2.0, 0.5), (0.25, 100.0, 1.0), (0.25, 0.1, 0.2), (0.0, 0.1, 1.0)]
)
def test_clip_distance_keeps_to_its_limits(share, thickness, expected):
    """Exact: 10 voxels of 0.1, a share of the thickness, two voxels; with share 0 the paper's constant."""
    assert limit_clip_distance(10.0, thickness, share, 0.1) == pytest.approx(expected)


@pytest.mark.parametrize("hardness", [0.0, 2.0])
def test_fields_vote_as_the_surface_of_a_view_does(hardness):
    """Exact: Eq. 15 with one term more for each field, in voxels that no view sees as well; sums stay as they were."""
    grid = VoxelGrid(np.array([-0.2, -0.1, 0.9]), 0.02, (21, 11, 11))
    fused = SoftMaximum(grid, 0.05, hardness, distrust=4.0, discontinuity=0.02)
    fused.add(FACING, np.full((81, 81), 1.0))
    before, seen = (array.copy() for array in fused.result())
    rng = np.random.default_rng(2)
    fields = rng.uniform(-1, 1, (2, *grid.shape)).astype(np.float32)
    trust = (0.3, rng.random(grid.shape))
    votes = [np.exp(hardness * (before - 1.0)) * (seen > 0)]
    votes += [np.exp(hardness * (field - 1.0) - 4.0 * (1 - own)) for field, own in zip(fields, trust, strict=True)]
    expected = sum(vote * field for vote, field in zip(votes, (before, *fields), strict=True)) / sum(votes)
    np.testing.assert_allclose(fused.result_with(list(zip(fields, trust, strict=True))), expected, atol=1e-6)
    np.testing.assert_array_equal(fused.result()[0], before)


def test_a_field_of_another_shape_is_rejected():
    fused = SoftMaximum(TOP, 0.05, 1.0, distrust=4.0, discontinuity=0.02)
    with pytest.raises(UserError, match="field"):
        fused.result_with([(np.zeros((3, 3, 3), np.float32), 1.0)])
