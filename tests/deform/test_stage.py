"""Contract, exact: the stage deform on a ball beside a chip, above a floor, with points on the ball alone."""

import numpy as np
import pytest

from threedfs.errors import UserError
from threedfs.geometry.grid import cover_box, voxel_centres
from threedfs.io.oriented_points import write_oriented_points
from threedfs.io.volumes import Volume, read_volume, write_support, write_volume
from threedfs.job import Job
from threedfs.params.deform import DeformParams
from threedfs.progress import Progress
from threedfs.stages import deform
from threedfs.types import Box, OrientedPoints, Plane, Support

BOX = Box(np.eye(3), np.full(3, -0.5), np.full(3, 0.5))
GRID = cover_box(BOX, 40)
CLIP = 6 * GRID.spacing
RADIUS = 0.3
BIAS = 1.0
"""How far the fused ball lies within the points, voxels."""
NAMES = ["a", "b", "c", "d"]
SMALL = {"controls": 400, "surface_points": 800, "anchors": 200, "rbf_width": 0.1}
"""A fit of seconds; fewer points are drawn than there are, as with the defaults on a real object."""


def write_scene(folder, engine="cpu"):
    """Write the field of a ball and of a chip a voxel and a half beside it, and points a voxel outside the ball."""
    places = voxel_centres(GRID)
    ball = np.linalg.norm(places, axis=-1) - (RADIUS - BIAS * GRID.spacing)
    chip = np.abs(places - [RADIUS + 2.5 * GRID.spacing, 0.0, 0.0]).max(axis=-1) - 1.2 * GRID.spacing
    sdf = np.clip(np.minimum(ball, chip) / CLIP, -1, 1).astype(np.float32)
    write_volume(folder / "field.zarr.zip", Volume(GRID, sdf, np.ones(GRID.shape, np.uint8)), {})
    support = Support(Plane(np.array([0.0, 0.0, 1.0]), 0.5), BOX, {"plane_noise": 0.002})
    write_support(folder / "support.json", support, {})
    rng = np.random.default_rng(0)
    normal = rng.normal(size=(3000, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    radius = RADIUS + rng.normal(0, 0.7 * GRID.spacing, 3000)
    radius[:200] += 3 * GRID.spacing  # wrong ones
    tilted = normal + rng.normal(0, 0.4, normal.shape)
    tilted /= np.linalg.norm(tilted, axis=1, keepdims=True)
    sightings = rng.integers(2, 5, 3000)
    seen = np.repeat(np.arange(3000), sightings), np.concatenate([np.arange(count) for count in sightings])
    points = OrientedPoints(
        (radius[:, None] * normal).astype(np.float32), tilted.astype(np.float32), np.zeros((3000, 3), np.uint8), *seen
    )
    write_oriented_points(folder / "cloud.zarr.zip", points, NAMES, engine, {})


def work(folder, clearance=1.5, noise_clearance=3.0, seed=0, threads=1, **changes):
    """Run the stage; return the bytes that it wrote."""
    deform.run(
        field=folder / "field.zarr.zip",
        support=folder / "support.json",
        cloud=folder / "cloud.zarr.zip",
        volume=folder / "volume.zarr.zip",
        clearance=clearance,
        noise_clearance=noise_clearance,
        params=DeformParams(**{**SMALL, **changes}),
        job=Job(Progress("test"), {"provenance": "test"}, threads, seed),
    )
    return (folder / "volume.zarr.zip").read_bytes()


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    """The inputs, and what the stage makes of them."""
    folder = tmp_path_factory.mktemp("deform")
    write_scene(folder)
    return folder, work(folder)


def radius_of(volume):
    """Mean radius of the ball's surface on the side without the chip, scene units."""
    places = voxel_centres(GRID)
    away = places[..., 0] < 0
    return (3 / (2 * np.pi) * ((volume.sdf < 0) & away).sum() * GRID.spacing**3) ** (1 / 3)


def test_the_field_moves_onto_the_points_and_the_chip_stays_apart(scene):
    folder, _ = scene
    before = read_volume(folder / "field.zarr.zip")
    work(folder)
    after = read_volume(folder / "volume.zarr.zip")
    np.testing.assert_array_equal(after.seen, before.seen)
    assert after.grid.shape == before.grid.shape and after.grid.spacing == before.grid.spacing
    assert radius_of(before) == pytest.approx(RADIUS - GRID.spacing, abs=0.1 * GRID.spacing)
    assert radius_of(after) == pytest.approx(RADIUS, abs=0.35 * GRID.spacing)


def test_without_points_the_field_is_as_fused(tmp_path):
    write_scene(tmp_path, engine="off")
    work(tmp_path)
    before, after = (read_volume(tmp_path / f"{name}.zarr.zip") for name in ("field", "volume"))
    np.testing.assert_array_equal(after.sdf, before.sdf)


def test_bytes_depend_on_the_seed_and_not_on_threads(scene):
    folder, first = scene
    assert work(folder, threads=2) == first
    assert work(folder, seed=1) != first


@pytest.mark.parametrize(
    "change",
    [
        {"rbf_width": 0.15},
        {"controls": 300},
        {"control_level": 0.3},
        {"surface_points": 500},
        {"cell": 0.0},
        {"scatter": 0.1},
        {"anchors": 100},
        {"ridge": 10.0},
        {"reach": 0.4},
        {"min_cosine": 0.95},
        {"full_sightings": 2},
        {"reweightings": 0},
        {"residual_scale": 0.02},
        {"keep_apart": False},
    ],
    ids=lambda change: next(iter(change)),
)
def test_every_parameter_changes_what_is_written(scene, change):
    folder, first = scene
    assert work(folder, **change) != first


def test_the_list_of_parameters_is_whole():
    (mark,) = test_every_parameter_changes_what_is_written.pytestmark
    assert {name for change in mark.args[1] for name in change} == set(DeformParams.__dataclass_fields__)


@pytest.mark.parametrize("change", [{"clearance": 30.0}, {"noise_clearance": 400.0}])
def test_solids_below_the_clearance_do_not_count(scene, change):
    """Property: with the chip below it, nothing is kept apart."""
    folder, first = scene
    assert work(folder, **change) == work(folder, keep_apart=False) != first


def test_points_of_one_side_are_refused(tmp_path):
    write_scene(tmp_path)
    normal = np.tile([1.0, 0.0, 0.0], (100, 1)).astype(np.float32)
    place = np.column_stack([np.full(100, RADIUS), *np.random.default_rng(0).uniform(-0.05, 0.05, (2, 100))])
    one_side = OrientedPoints(
        place.astype(np.float32),
        normal,
        np.zeros((100, 3), np.uint8),
        np.repeat(np.arange(100), 4),
        np.tile(range(4), 100),
    )
    write_oriented_points(tmp_path / "cloud.zarr.zip", one_side, NAMES, "cpu", {})
    with pytest.raises(UserError, match="side"):
        work(tmp_path)
