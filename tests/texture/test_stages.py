"""Contract: the stages texture and photographs on a ball that stands on a plane, photographed from all around."""

import dataclasses
import io

import numpy as np
import pytest
import trimesh
from painted_ball import CAMERA, RADIUS, ball, photograph, ring

from threedfs.errors import UserError
from threedfs.geometry.rigid import look_at
from threedfs.io.crops import Crop, write_crops
from threedfs.io.keyframes import write_keyframes
from threedfs.io.meshes import read_mesh, write_mesh
from threedfs.io.metrics import read_metrics
from threedfs.io.texture import read_texture
from threedfs.io.textured_meshes import read_textured_obj
from threedfs.io.volumes import write_support
from threedfs.job import Job
from threedfs.params.photographs import PhotographsParams
from threedfs.params.texture import TextureParams
from threedfs.progress import Progress
from threedfs.stages import photographs, texture
from threedfs.types import Box, Keyframe, Mesh, Plane, Support

UP = np.array([0.6, 0.0, 0.8])
"""Normal of the plane that the ball stands on: not an axis of the world."""
COUNT = 12


@dataclasses.dataclass
class Scene:
    """Paths of a sequence, and what its log said."""

    folder: object
    log: io.StringIO

    def paint(self, **changes):
        """Run the stage texture; return what was written: the names of all files, and their bytes."""
        folder = self.folder
        texture.run(
            mesh=folder / "mesh.ply",
            support=folder / "support.json",
            keyframes=folder / "keyframes.json",
            crops=folder / "crops.zarr.zip",
            glb=folder / "mesh.glb",
            textured=folder / "textured",
            method="surface",
            params=TextureParams(**({"tolerance": 0.003, "held_out_step": 4} | changes)),
            job=Job(Progress("texture", self.log), {"provenance": "test"}),
        )
        return {
            path.name: path.read_bytes() for path in [folder / "mesh.glb", *sorted((folder / "textured").iterdir())]
        }

    def compare(self, seed=0, **changes):
        """Run the stage photographs; return the figures by name."""
        folder = self.folder
        photographs.run(
            mesh=folder / "mesh.ply",
            textured=folder / "textured",
            keyframes=folder / "keyframes.json",
            crops=folder / "crops.zarr.zip",
            metrics=folder / "photographs.csv",
            dataset="toys",
            sequence="ball",
            method="surface",
            params=PhotographsParams(**({"surface_samples": 2000} | changes)),
            job=Job(Progress("photographs", self.log), seed=seed),
        )
        rows = read_metrics(folder / "photographs.csv")
        assert {(row.dataset, row.sequence, row.method, row.keyframe) for row in rows} == {
            ("toys", "ball", "surface", "")
        }
        assert len({row.name for row in rows}) == len(rows)
        return {row.name: row.value for row in rows}


@pytest.fixture(scope="module")
def images():
    """Photographs of the ball by name, one of them brighter."""
    fine = ball(5)
    shown = {view.name: photograph(fine, view) for view in ring(COUNT)}
    shown["000003"] = np.clip(1.15 * shown["000003"], 0, 255).astype(np.uint8)
    return shown


@pytest.fixture
def scene(images, tmp_path):
    """What the stages read: every other view is a keyframe, those between are their neighbours alone."""
    views = ring(COUNT)
    keyframes = [
        Keyframe(view, (views[rank + 1], views[rank - 2]), 1.5, 3.5) for rank, view in enumerate(views) if rank % 2 == 0
    ]
    write_keyframes(tmp_path / "keyframes.json", keyframes, {})
    crops = (Crop(name, image, np.ones(CAMERA.shape, bool)) for name, image in images.items())
    write_crops(tmp_path / "crops.zarr.zip", crops, {}, ordered=True, source_shape=CAMERA.shape)
    box = Box(np.eye(3), np.full(3, -RADIUS), np.full(3, RADIUS))
    write_support(tmp_path / "support.json", Support(Plane(UP, RADIUS), box, {}), {})
    write_mesh(tmp_path / "mesh.ply", ball(4))
    return Scene(tmp_path, io.StringIO())


def test_three_files_and_a_record_are_written(scene):
    assert list(scene.paint()) == ["mesh.glb", "mesh.mtl", "mesh.obj", "mesh.png", "painted.json"]
    record = read_texture(scene.folder / "textured/painted.json")
    assert record.held_out == ["000002", "000006", "000010"]
    assert record.painted_from == [f"{rank:06d}" for rank in range(COUNT) if rank % 4 != 2]
    assert record.charts >= 9 and 0.05 < record.unseen_share < 0.2
    assert f"triangles for 5120, {record.charts} charts, " in scene.log.getvalue()


def test_the_obj_lies_in_the_world_and_the_glb_stands_upright(scene):
    """Exact: the same faces with the same texels; in GLB y is up, and the foot at 0."""
    scene.paint()
    painted = read_textured_obj(scene.folder / "textured/mesh.obj")
    radii = np.linalg.norm(painted.mesh.vertices, axis=1)
    np.testing.assert_allclose(radii, RADIUS, atol=1e-6)
    glb = trimesh.load(scene.folder / "mesh.glb", force="mesh", process=False)
    low, high = glb.vertices.min(axis=0), glb.vertices.max(axis=0)
    np.testing.assert_allclose(low[1], 0, atol=1e-6)
    np.testing.assert_allclose((low + high)[[0, 2]], 0, atol=1e-6)
    assert high[1] == pytest.approx(2 * RADIUS, rel=0.02)
    assert trimesh.Trimesh(glb.vertices, glb.faces).is_watertight
    picture = np.asarray(glb.visual.material.baseColorTexture.convert("RGB"))
    np.testing.assert_array_equal(picture, painted.image)
    # the height of each corner above the plane is its y
    heights = np.sort((painted.mesh.vertices[painted.mesh.faces] @ UP).ravel())
    np.testing.assert_allclose(np.sort(glb.vertices[glb.faces][..., 1].ravel()), heights - heights[0], atol=1e-6)


def test_the_same_bytes_twice(scene):
    assert scene.paint() == scene.paint()
    assert scene.compare() == scene.compare()


TEXTURE_CHANGES = [
    {"tolerance": 0.01},
    {"views": 4},
    {"held_out_step": 5},
    {"seam_cost": 0.0},
    {"texels": 1.0},
]


@pytest.mark.parametrize("change", TEXTURE_CHANGES, ids=str)
def test_every_parameter_of_the_texture_acts(scene, change):
    plain, other = scene.paint(), scene.paint(**change)
    assert plain["mesh.obj"] != other["mesh.obj"] and plain["mesh.png"] != other["mesh.png"]
    assert plain["mesh.glb"] != other["mesh.glb"]


@pytest.mark.parametrize("change", [{"least_pixels": 100_000}, {"surface_samples": 1500}], ids=str)
def test_every_parameter_of_the_photographs_acts(scene, change):
    scene.paint()
    assert scene.compare(**change) != scene.compare()


def test_no_parameter_is_forgotten_here():
    """Contract: the changes above are of all there are."""
    changed = {name for change in TEXTURE_CHANGES for name in change}
    assert changed == {field.name for field in dataclasses.fields(TextureParams)}
    assert {field.name for field in dataclasses.fields(PhotographsParams)} == {"least_pixels", "surface_samples"}


def test_without_tolerance_all_faces_stay(scene):
    scene.paint(tolerance=0.0)
    assert len(read_mesh(scene.folder / "textured/mesh.obj").faces) == 5120
    assert "5120 triangles for 5120" in scene.log.getvalue()


def test_a_mesh_that_is_not_closed_is_painted_with_all_its_faces(scene):
    """Contract: and the log says why."""
    open_mesh = Mesh(ball(4).vertices, ball(4).faces[3:])
    write_mesh(scene.folder / "mesh.ply", open_mesh)
    scene.paint()
    assert "mesh.ply is not closed, so its texture has all of its faces" in scene.log.getvalue()
    assert len(read_textured_obj(scene.folder / "textured/mesh.obj").mesh.faces) == 5117


def test_only_what_crops_and_keyframes_both_have_is_painted_from(scene, images):
    """Contract: a crop without a camera, and a camera without a crop, are left out."""
    kept = [name for name in images if name != "000004"]
    crops = [Crop(name, images[name], np.ones(CAMERA.shape, bool)) for name in kept]
    crops.append(Crop("elsewhere", images["000004"], np.ones(CAMERA.shape, bool)))
    write_crops(scene.folder / "crops.zarr.zip", crops, {}, ordered=True, source_shape=CAMERA.shape)
    scene.paint()
    record = read_texture(scene.folder / "textured/painted.json")
    assert sorted(record.painted_from + record.held_out) == kept


def test_held_out_photographs_are_met_closely(scene):
    """Property: the texture more so than colours at the vertices of the same, coarse mesh."""
    scene.paint()
    found = scene.compare()
    assert found["photos"] == 3
    assert found["photo_psnr"] > 36 and found["photo_ssim"] > 0.97
    assert found["photo_psnr_vertices"] < found["photo_psnr"] - 2
    assert 0 < found["photo_ssim_vertices"] < found["photo_ssim"]
    assert 0.05 < found["texture_deviation"] < 0.3  # in percent; the tolerance is 0.3


def test_held_out_photographs_leave_no_trace_in_the_texture(scene, images):
    """Property: noise in their place changes nothing but the figures."""
    plain = scene.paint()
    noise = np.random.default_rng(0).integers(0, 256, (*CAMERA.shape, 3), np.uint8)
    spoiled = images | dict.fromkeys(("000002", "000006", "000010"), noise)
    crops = (Crop(name, image, np.ones(CAMERA.shape, bool)) for name, image in spoiled.items())
    write_crops(scene.folder / "crops.zarr.zip", crops, {}, ordered=True, source_shape=CAMERA.shape)
    assert scene.paint() == plain
    assert scene.compare()["photo_psnr"] < 15


def test_without_held_out_photographs_only_the_deviation_is_measured(scene):
    scene.paint(held_out_step=0)
    record = read_texture(scene.folder / "textured/painted.json")
    assert record.held_out == [] and len(record.painted_from) == COUNT
    assert set(scene.compare()) == {"texture_deviation"}


def test_a_held_out_photograph_of_something_else_does_not_count(scene):
    """Contract: one camera looks past the ball, and there is no figure of it."""
    views = ring(COUNT)
    up, centre = np.array([0.0, 0, 1]), views[2].centre
    views[2] = dataclasses.replace(views[2], cam_from_world=look_at(centre, 2 * np.cross(up, centre), up))
    write_keyframes(scene.folder / "keyframes.json", [Keyframe(view, (), 1.5, 3.5) for view in views], {})
    scene.paint()
    assert scene.compare()["photos"] == 2


def test_a_textured_folder_without_its_picture_is_refused(scene):
    scene.paint()
    (scene.folder / "textured/mesh.png").unlink()
    with pytest.raises(UserError, match=r"its \.mtl and \.png belong beside it"):
        scene.compare()
    assert not (scene.folder / "photographs.csv").exists()
