"""Contract: the stage fuse_baseline on exact depth of a sphere on a table, by every fusion."""

import numpy as np
import pytest

from threedfs.geometry.grid import voxel_centres
from threedfs.io.depth_maps import DepthMap, write_depth_map
from threedfs.io.keyframes import write_keyframes
from threedfs.io.volumes import read_volume, write_support
from threedfs.job import Job
from threedfs.params.fuse_baseline import FuseBaselineParams
from threedfs.progress import Progress
from threedfs.stages import fuse_baseline
from threedfs.types import Box, Keyframe, Plane, Support

FUSIONS = ["tsdf", "hard_maximum", "soft_maximum"]
SIDE = 40


@pytest.fixture(scope="module")
def folder(table, tmp_path_factory):
    """What the stage reads."""
    folder = tmp_path_factory.mktemp("baseline")
    for view in table.views:
        depth = table.depth(view)
        ones = np.ones(depth.shape, np.float32)
        write_depth_map(folder / "depth" / f"{view.name}.zarr.zip", DepthMap(np.float32(depth), 0 * ones, ones), {})
    write_keyframes(folder / "keyframes.json", [Keyframe(view, (), 0.5, 3.0) for view in table.views], {})
    box = Box(np.eye(3), table.centre - 1.3 * table.radius, table.centre + 1.3 * table.radius)
    plane = Plane(np.array([0.0, 0.0, 1.0]), 0.0)
    write_support(folder / "support.json", Support(plane, box, {"thickness": 2 * table.radius}), {})
    return folder


def work(folder, fusion, threads=1, **changes):
    """Run the stage; return the bytes that it wrote."""
    fuse_baseline.run(
        keyframes=folder / "keyframes.json",
        depth=sorted((folder / "depth").iterdir()),
        support=folder / "support.json",
        volume=folder / "volume.zarr.zip",
        fusion=fusion,
        params=FuseBaselineParams(**{"longest_side": SIDE, "clip_distance": 6.0, **changes}),
        job=Job(Progress("test"), {"provenance": "test"}, threads),
    )
    return (folder / "volume.zarr.zip").read_bytes()


@pytest.mark.parametrize("fusion", FUSIONS)
def test_the_field_is_that_of_the_sphere(folder, table, fusion):
    """Oracle: above the sphere's middle, signs agree but for the surface's own voxels."""
    work(folder, fusion)
    volume = read_volume(folder / "volume.zarr.zip")
    assert max(volume.grid.shape) == SIDE
    places = voxel_centres(volume.grid)
    distance = np.linalg.norm(places - table.centre, axis=-1) - table.radius
    clear = (places[..., 2] > table.radius) & (np.abs(distance) > 1.2 * volume.grid.spacing)
    assert clear.sum() > 10_000
    assert ((volume.sdf < 0) == (distance < 0))[clear].mean() > 0.999
    assert volume.seen[clear].max() == len(table.views)


def test_fusions_differ_and_threads_do_not_matter(folder):
    made = {fusion: work(folder, fusion) for fusion in FUSIONS}
    assert len(set(made.values())) == len(FUSIONS)
    assert all(work(folder, fusion, threads=2) == expected for fusion, expected in made.items())


CHANGES = [{"longest_side": 30}, {"clip_distance": 4.0}, {"thickness_share": 0.05}, {"depth_discontinuity": 0.5}]


@pytest.mark.parametrize("change", CHANGES, ids=lambda change: next(iter(change)))
@pytest.mark.parametrize("fusion", FUSIONS)
def test_every_parameter_changes_what_is_written(folder, fusion, change):
    assert work(folder, fusion, **change) != work(folder, fusion)


def test_the_list_of_parameters_is_whole():
    assert {name for change in CHANGES for name in change} == set(FuseBaselineParams.__dataclass_fields__)
