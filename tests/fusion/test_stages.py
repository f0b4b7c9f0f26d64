"""Contract tests of the stages from depth maps to the object, on a sphere that floats just above a table."""

import io
from dataclasses import replace

import numpy as np
import pytest
import trimesh

from threedfs.errors import UserError
from threedfs.geometry.grid import voxel_centres
from threedfs.geometry.projection import backproject_map
from threedfs.geometry.similarity import Similarity
from threedfs.io.consistency import read_consistency, write_consistency
from threedfs.io.crops import Crop, write_crops
from threedfs.io.depth_maps import DepthMap, Semidense, write_depth_map, write_edges, write_semidense
from threedfs.io.frames import Frame, write_frames
from threedfs.io.images import read_mask
from threedfs.io.keyframes import write_keyframes
from threedfs.io.points import write_points
from threedfs.io.poses import Poses, write_poses
from threedfs.io.volumes import read_silhouettes, read_support, read_volume, write_volume
from threedfs.job import Job
from threedfs.params.consistency import ConsistencyParams
from threedfs.params.fuse_object import FuseObjectParams
from threedfs.params.fuse_scene import FuseSceneParams
from threedfs.params.locate import LocateParams
from threedfs.params.locate_object import LocateObjectParams
from threedfs.params.schema import default_settings
from threedfs.params.segment import SegmentParams
from threedfs.progress import Progress
from threedfs.stages import consistency, fuse_object, fuse_scene, locate, locate_object
from threedfs.stages import object as object_stage
from threedfs.types import Keyframe, SparsePoints

HEADER = {"provenance": "test"}


def lay_out(folder, scene):
    """Write what the stages before fusion would have: exact depth, points on a tenth of the pixels."""
    rng = np.random.default_rng(0)
    clouds = []
    for view in scene.views:
        depth = scene.depth(view)
        ones = np.ones(depth.shape, np.float32)
        write_depth_map(folder / "depth" / f"{view.name}.zarr.zip", DepthMap(np.float32(depth), 0 * ones, ones), HEADER)
        inverse = np.where(rng.random(depth.shape) < 0.1, 1 / depth, np.nan).astype(np.float32)
        semidense = Semidense(inverse, (0.01 * inverse) ** 2)
        write_semidense(folder / "semidense" / f"{view.name}.zarr.zip", semidense, HEADER)
        write_edges(folder / "edges" / f"{view.name}.zarr.zip", 0 * ones, HEADER)
        clouds.append(backproject_map(view, 1 / inverse.astype(np.float64))[np.isfinite(inverse)])
    xyz = np.concatenate(clouds)
    xyz = xyz[np.linalg.norm(xyz, axis=1) < 2]
    none = np.zeros(len(xyz), np.int64)
    sparse = SparsePoints(xyz, np.zeros((len(xyz), 3), np.uint8), np.ones(len(xyz)), none, none)
    write_points(folder / "points.zarr.zip", sparse, HEADER)
    keyframes = [Keyframe(view, (), 0.5, 3.0) for view in scene.views]
    write_keyframes(folder / "keyframes.json", keyframes, HEADER)
    poses = Poses(tuple(scene.views), (), (0.0, 0.0), Similarity(1.0, np.eye(3), np.zeros(3)))
    write_poses(folder / "poses.json", poses, HEADER)
    crops = [Crop(view.name, scene.image(view), np.isfinite(scene.depth(view))) for view in scene.views]
    write_crops(folder / "crops.zarr.zip", crops, HEADER, ordered=True, source_shape=(240, 320))
    blank = np.zeros((*scene.views[0].camera.shape, 3), np.uint8)
    frames = [Frame(view.name, 0, 0.0, 1.0, blank) for view in scene.views]
    write_frames(folder / "frames.zarr.zip", frames, HEADER, ordered=True, source_shape=(240, 320))


def fuse(folder, volume, params, job, trust=None, scene=None):
    """Run fuse_object on what is in a folder, with another trust or scene if it is given."""
    fuse_object.run(
        keyframes=folder / "keyframes.json",
        depth=sorted((folder / "depth").iterdir()),
        consistency=trust or folder / "consistency.zarr.zip",
        support=folder / "support.json",
        scene=scene or folder / "scene.zarr.zip",
        volume=volume,
        params=params,
        job=job,
    )


def run_all(folder, threads=1, point_deviation=0.05):
    job = Job(Progress("test"), HEADER, threads)
    depth, semidense, edges = (sorted((folder / name).iterdir()) for name in ("depth", "semidense", "edges"))
    at = {"keyframes": folder / "keyframes.json"}
    agreement = folder / "consistency.zarr.zip"
    consistency.run(**at, depth=depth, consistency=agreement, params=ConsistencyParams(), job=job)
    fuse_scene.run(
        **at,
        points=folder / "points.zarr.zip",
        depth=depth,
        consistency=agreement,
        scene=folder / "scene.zarr.zip",
        params=FuseSceneParams(longest_side=60),
        job=job,
    )
    locate.run(
        **at,
        scene=folder / "scene.zarr.zip",
        points=folder / "points.zarr.zip",
        crops=folder / "crops.zarr.zip",
        semidense=semidense,
        edges=edges,
        depth=depth,
        consistency=agreement,
        support=folder / "support.json",
        segmentation=default_settings(SegmentParams),
        clearance=LocateObjectParams().clearance,
        params=LocateParams(plane_candidates=500, point_deviation=point_deviation),
        job=job,
    )
    fuse(folder, folder / "object.zarr.zip", FuseObjectParams(longest_side=60), job)
    locate_object.run(
        **at,
        volume=folder / "object.zarr.zip",
        support=folder / "support.json",
        semidense=semidense,
        located=folder / "located.zarr.zip",
        field="fused_sdf",
        params=LocateObjectParams(),
        job=job,
    )
    object_stage.run(
        **at,
        field=folder / "object.zarr.zip",
        located=folder / "located.zarr.zip",
        poses=folder / "poses.json",
        frames=folder / "frames.zarr.zip",
        mesh=folder / "mesh.ply",
        volume=folder / "volume.zarr.zip",
        silhouettes=folder / "silhouettes.zarr.zip",
        masks=folder / "masks",
        method="fused_sdf",
        job=job,
    )


@pytest.fixture(scope="module")
def results(table, tmp_path_factory):
    folder = tmp_path_factory.mktemp("stages")
    lay_out(folder, table)
    run_all(folder)
    return folder


def test_support_and_box(results, table):
    """Oracle: the table is z = 0, and the box holds the sphere without the rest of the table."""
    support = read_support(results / "support.json")
    assert np.degrees(np.arccos(support.plane.normal[2])) < 0.5
    assert abs(support.plane.offset) < 0.01  # a third of a scene voxel
    np.testing.assert_array_equal(support.box.axes[2], support.plane.normal)
    assert (support.box.low < support.box.axes @ table.centre - table.radius).all()
    assert (support.box.high > support.box.axes @ table.centre + table.radius).all()
    assert support.box.longest < 2 * 2 * table.radius
    assert support.figures["thickness"] == pytest.approx(2 * table.radius, rel=0.2)


def test_one_grid_for_scene_and_object(results, tmp_path):
    """Contract: with `grid: region` the object's field has the voxels of the scene's, and its own plain fusion."""
    params = FuseObjectParams(grid="region", thickness_share=0.0)
    fuse(results, tmp_path / "object.zarr.zip", params, Job(Progress("test"), HEADER, 1))
    own, scene = read_volume(tmp_path / "object.zarr.zip"), read_volume(results / "scene.zarr.zip")
    assert own.grid.shape == scene.grid.shape and own.grid.spacing == scene.grid.spacing
    assert np.array_equal(own.grid.origin, scene.grid.origin) and np.array_equal(own.grid.axes, scene.grid.axes)
    assert np.array_equal(own.seen, scene.seen)


@pytest.mark.parametrize("change", [{"mirrored_height": 0.0}, {"mirrored_from": 0.2}, {"mirrored_full": 0.9}], ids=str)
def test_parameters_of_doubt_act(results, tmp_path, change):
    """Contract: the sphere's lower part counts as mirrored, and its depth as half sure."""
    store = read_consistency(results / "consistency.zarr.zip")
    unsure = (
        (name, replace(found, confidence=0.8 * found.confidence))
        for name in store.names
        for found in [store.read(name)]
    )
    write_consistency(tmp_path / "consistency.zarr.zip", unsure, HEADER)

    def doubt(**settings):
        log, volume = io.StringIO(), tmp_path / "object.zarr.zip"
        base = {"longest_side": 60, "mirrored_height": 0.3, "mirrored_from": 0.6, "mirrored_full": 1.0}
        job = Job(Progress("test", log), HEADER, 1)
        fuse(results, volume, FuseObjectParams(**(base | settings)), job, tmp_path / "consistency.zarr.zip")
        return read_volume(volume).sdf, log.getvalue()

    plain, said = doubt()
    assert "depth is unsure: mirror images of the support plane count 0." in said
    assert not np.array_equal(plain, doubt(**change)[0])


def test_notches_of_the_coarse_object_are_doubted_too(results, table, tmp_path, monkeypatch):
    """Contract: with its notch filled, a coarse sphere that was cut into serves more like a whole one."""
    whole = read_volume(results / "scene.zarr.zip")
    x, _, z = np.moveaxis(voxel_centres(whole.grid) - table.centre, -1, 0) / table.radius
    notched = replace(whole, sdf=np.where((np.abs(x) < 0.25) & (z > -0.85) & (z < -0.2), np.float32(1), whole.sdf))
    write_volume(tmp_path / "scene.zarr.zip", notched, HEADER)
    params = FuseObjectParams(longest_side=60, mirrored_height=0.3, mirrored_from=0.999, mirrored_full=1.0)

    def doubt(scene):
        log, volume = io.StringIO(), tmp_path / "object.zarr.zip"
        fuse(results, volume, params, Job(Progress("test", log), HEADER, 1), scene=scene / "scene.zarr.zip")
        assert "mirror images of the support plane count 0.00" in log.getvalue()
        return read_volume(volume).sdf

    expected, filled = doubt(results), doubt(tmp_path)
    monkeypatch.setattr(fuse_object, "fill_notches", lambda grid, solid, _: (grid, solid))
    assert np.abs(filled - expected).sum() < np.abs(doubt(tmp_path) - expected).sum()


def test_mesh_is_the_sphere_closed(results, table):
    """Oracle: one closed shell within a voxel and a half of the sphere and its foot."""
    mesh = trimesh.load(results / "mesh.ply", process=False)
    spacing = read_volume(results / "volume.zarr.zip").grid.spacing
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.body_count == 1
    assert mesh.volume == pytest.approx(4 / 3 * np.pi * table.radius**3, rel=0.15)
    upper = mesh.vertices[mesh.vertices[:, 2] > table.radius]
    assert np.abs(np.linalg.norm(upper - table.centre, axis=1) - table.radius).max() < 1.5 * spacing
    assert mesh.vertices[:, 2].min() > -0.5 * spacing


def test_silhouettes_are_the_spheres_outlines(results, table):
    """Oracle: rays that hit the sphere; a maximum loses up to a voxel (here 1.4 pixels) around it."""
    silhouettes = read_silhouettes(results / "silhouettes.zarr.zip")
    assert sorted(silhouettes) == [view.name for view in table.views]
    for view in table.views:
        rays = backproject_map(view, np.ones(view.camera.shape)) - view.centre
        toward = table.centre - view.centre
        hit = (rays @ toward) ** 2 / (rays**2).sum(-1) >= toward @ toward - table.radius**2
        mask = silhouettes[view.name]
        assert (mask & hit).sum() / (mask | hit).sum() > 0.9
        assert read_mask(results / "masks" / f"{view.name}.png").shape == (240, 320)


def test_consistency_is_read_by_keyframe(results, table):
    """Contract: what was streamed in comes out under its name."""
    store = read_consistency(results / "consistency.zarr.zip")
    assert store.names == tuple(view.name for view in table.views)
    item = store.read(table.views[4].name)
    assert item.confidence.shape == table.views[4].camera.shape
    assert item.agree.dtype == np.uint8
    assert (item.confidence >= 0).all()
    assert (item.confidence <= 1).all()


def test_bytes_do_not_depend_on_threads(results, table, tmp_path):
    """Exact: everything again with two threads."""
    lay_out(tmp_path, table)
    run_all(tmp_path, threads=2)
    made = [path.relative_to(tmp_path) for path in sorted(tmp_path.rglob("*")) if path.is_file()]
    assert len(made) == 3 * len(table.views) + 5 + 7 + 1 + len(table.views)
    for path in made:
        assert (tmp_path / path).read_bytes() == (results / path).read_bytes(), path


def test_object_without_points_is_told(table, tmp_path):
    """Rejection: no semi-dense point is sure enough to support an object."""
    lay_out(tmp_path, table)
    with pytest.raises(UserError, match="No object was found above the support plane"):
        run_all(tmp_path, point_deviation=0.001)


def test_keyframe_without_a_depth_map_is_told(table, tmp_path):
    """Rejection: the first keyframe's depth map is missing."""
    lay_out(tmp_path, table)
    depth = sorted((tmp_path / "depth").iterdir())[1:]
    with pytest.raises(UserError, match=f"found none for {table.views[0].name}; run again, rule depth"):
        consistency.run(
            keyframes=tmp_path / "keyframes.json",
            depth=depth,
            consistency=tmp_path / "consistency.zarr.zip",
            params=ConsistencyParams(),
            job=Job(Progress("test"), HEADER),
        )
