"""Contract: the stage poisson on oriented points of a ball that stands on a table."""

import numpy as np
import pytest
import trimesh

from threedfs.geometry.projection import backproject_map
from threedfs.geometry.rigid import look_at
from threedfs.geometry.similarity import Similarity
from threedfs.io.frames import Frame, write_frames
from threedfs.io.images import read_mask
from threedfs.io.keyframes import write_keyframes
from threedfs.io.oriented_points import write_oriented_points
from threedfs.io.poses import Poses, write_poses
from threedfs.io.volumes import read_silhouettes, write_support
from threedfs.job import Job
from threedfs.params.poisson import PoissonParams
from threedfs.progress import Progress
from threedfs.stages import poisson
from threedfs.types import Box, Camera, Keyframe, OrientedPoints, Plane, Support, View

RADIUS = 0.25
CENTRE = np.array([0.0, 0.0, RADIUS])
CAMERA = Camera(96, 72, 90.0, 90.0, 47.5, 35.5)
VIEWS = [
    View(name, CAMERA, look_at(1.2 * np.array([np.cos(angle), np.sin(angle), 0.8]), CENTRE, np.array([0.0, 0.0, 1.0])))
    for name, angle in (("a", 0.0), ("b", 2.0), ("c", 4.0))
]
COUNT = 4000


def make_points():
    """Points of the ball, seen by two to five views, and of the table around it."""
    rng = np.random.default_rng(0)
    normal = rng.normal(size=(COUNT, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    ball = CENTRE + RADIUS * normal
    table = np.column_stack([rng.uniform(-0.3, 0.3, (COUNT // 4, 2)), np.zeros(COUNT // 4)])
    xyz = np.vstack([ball, table])
    normals = np.vstack([normal, np.tile([0.0, 0.0, 1.0], (len(table), 1))])
    sightings = rng.integers(2, 6, len(xyz))
    seen = np.repeat(np.arange(len(xyz)), sightings), np.concatenate([np.arange(count) for count in sightings])
    return OrientedPoints(xyz.astype(np.float32), normals.astype(np.float32), np.zeros((len(xyz), 3), np.uint8), *seen)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """What the stage reads."""
    folder = tmp_path_factory.mktemp("poisson")
    write_oriented_points(folder / "cloud.zarr.zip", make_points(), ["a", "b", "c", "d", "e"], "cpu", {})
    box = Box(np.eye(3), np.array([-0.35, -0.35, -0.05]), np.array([0.35, 0.35, 0.6]))
    write_support(folder / "support.json", Support(Plane(np.array([0.0, 0.0, 1.0]), 0.0), box, {}), {})
    write_keyframes(folder / "keyframes.json", [Keyframe(view, (), 0.5, 3.0) for view in VIEWS], {})
    same = Similarity(1.0, np.eye(3), np.zeros(3))
    write_poses(folder / "poses.json", Poses(tuple(VIEWS), (), (0.0, 0.0), same), {})
    blank = np.zeros((*CAMERA.shape, 3), np.uint8)
    frames = [Frame(view.name, 0, 0.0, 1.0, blank) for view in VIEWS]
    write_frames(folder / "frames.zarr.zip", frames, {}, ordered=True, source_shape=(144, 192))
    return folder


def work(folder, **changes):
    """Run the stage; return the bytes of the mesh, of the silhouettes and of the masks."""
    poisson.run(
        cloud=folder / "cloud.zarr.zip",
        support=folder / "support.json",
        keyframes=folder / "keyframes.json",
        poses=folder / "poses.json",
        frames=folder / "frames.zarr.zip",
        mesh=folder / "mesh.ply",
        silhouettes=folder / "silhouettes.zarr.zip",
        masks=folder / "masks",
        params=PoissonParams(**{"octree_depth": 5, **changes}),
        job=Job(Progress("test"), {"provenance": "test"}),
    )
    made = [folder / "mesh.ply", folder / "silhouettes.zarr.zip", *sorted((folder / "masks").iterdir())]
    return [path.read_bytes() for path in made]


def test_the_ball_comes_out_with_its_masks(folder):
    """Oracle: its size, and the rays that hit it; below the table, where there are no points, it may be open."""
    work(folder)
    mesh = trimesh.load(folder / "mesh.ply", process=False)
    edges, faces = np.unique(mesh.edges_sorted, axis=0, return_counts=True)
    assert mesh.body_count == 1 and (mesh.vertices[edges[faces != 2]][..., 2] < 0).all()
    upper = mesh.vertices[mesh.vertices[:, 2] > 0.1]
    assert np.abs(np.linalg.norm(upper - CENTRE, axis=1) - RADIUS).max() < 0.02
    silhouettes = read_silhouettes(folder / "silhouettes.zarr.zip")
    for view in VIEWS:
        rays = backproject_map(view, np.ones(CAMERA.shape)) - view.centre
        toward = CENTRE - view.centre
        hit = (rays @ toward) ** 2 / (rays**2).sum(-1) >= toward @ toward - RADIUS**2
        found = silhouettes[view.name]
        assert (found & hit).sum() / (found | hit).sum() > 0.95
        mask = read_mask(folder / "masks" / f"{view.name}.png")
        assert mask.shape == (144, 192) and mask.mean() == pytest.approx(found.mean(), rel=0.03)


def test_the_same_bytes_twice(folder):
    assert work(folder) == work(folder)


CHANGES = [{"octree_depth": 4}, {"clearance": 0.3}, {"min_sightings": 5}]


@pytest.mark.parametrize("change", CHANGES, ids=lambda change: next(iter(change)))
def test_every_parameter_changes_what_is_written(folder, change):
    assert work(folder, **change) != work(folder)


def test_the_list_of_parameters_is_whole():
    assert {name for change in CHANGES for name in change} == set(PoissonParams.__dataclass_fields__)
