"""Exact, property and rejection: the stage on a run whose results are the truth itself, and on faulty truth."""

import json
from dataclasses import replace

import cv2
import numpy as np
import pytest

from threedfs.errors import UserError
from threedfs.io.depth_maps import read_depth_map, write_depth_map
from threedfs.io.images import read_mask, write_mask
from threedfs.io.keyframes import read_keyframes, write_keyframes
from threedfs.io.meshes import read_mesh, write_mesh
from threedfs.io.poses import read_poses
from threedfs.io.volumes import read_silhouettes, write_silhouettes
from threedfs.object.silhouettes import draw_source_silhouette
from threedfs.params.evaluate import EvaluateParams
from threedfs.params.evaluate_reconstruction import EvaluateReconstructionParams
from threedfs.types import Mesh

LENS, SOURCE = (0.08, 0.01), (120, 160)
"""Distortion and shape of the run's source."""
SOUNDNESS = {"mesh_genus", "mesh_closed", "mesh_pieces", "mesh_filled"}


def test_the_truth_scores_full_marks(finished):
    found = finished.score()
    assert set(found["iou"]) == {f"{10 * number:06d}" for number in range(6)}
    # the same mesh drawn in two worlds: a pixel centre on an edge may round either way
    assert found["iou_min"] > 0.995
    assert set(found["iou_unseen"]) == {"between_0", "between_1"} and found["iou_unseen_mean"] > 0.995
    assert found["depth_error_median"] < 1e-4  # depth maps are float32: 6e-8 relative, in percent
    assert found["depth_covered"] > 99.9
    assert found["pose_centre_error_max"] < 1e-7 and found["pose_rotation_error_max"] < 1e-5
    # 2000 samples, 3 % of the diagonal apart: beside an edge the nearest face is missed now and then
    assert found["mesh_f_score_0.5"] > 0.99 and found["mesh_chamfer"] < 0.01
    assert found["mesh_closed"] == found["mesh_pieces"] == 1 and 0 < found["mesh_filled"] <= 1
    assert found["frames_posed"] == 100
    assert (found["path_turns"], found["path_continuity"], found["reprojection_error"]) == (0.75, 1.5, 0.4)
    assert not any(name.startswith("cylinder") for name in found)


def test_a_grown_mesh_and_a_scaled_depth_show_by_how_much(finished):
    mesh = read_mesh(finished.inputs["mesh"])
    middle = mesh.vertices.mean(0)
    write_mesh(finished.folder / "grown.ply", Mesh(middle + 1.1 * (mesh.vertices - middle), mesh.faces))
    for path in finished.inputs["depth"]:
        depth_map = read_depth_map(path)
        write_depth_map(path, replace(depth_map, depth=1.02 * depth_map.depth), {})
    found = finished.score(mesh=finished.folder / "grown.ply")
    assert found["depth_error_median"] == pytest.approx(2, abs=1e-3)
    assert found["depth_within_1"] == 0 and found["depth_within_10"] > 99.9
    assert found["iou_unseen_mean"] == pytest.approx(1 / 1.1**2, abs=0.03)  # areas grow by about the square
    assert found["mesh_f_score_1"] < 0.1


def test_the_table_is_the_same_twice(finished):
    tables = [finished.folder / name for name in ("metrics.csv", "reconstruction.csv")]
    finished.score()
    first = [path.read_bytes() for path in tables]
    finished.score()
    assert [path.read_bytes() for path in tables] == first


@pytest.mark.parametrize(
    "change",
    [
        {"reconstruction": EvaluateReconstructionParams(silhouette_erosion=5)},
        {"params": EvaluateParams(surface_samples=1500)},
        {"params": EvaluateParams(surface_samples=2000, mesh_thresholds=(2.0,))},
    ],
)
def test_every_parameter_changes_the_table(finished, change):
    # a depth error that grows towards the border gives the parameters something to act on
    path = finished.inputs["depth"][0]
    depth_map = read_depth_map(path)
    factor = 1 + 0.01 * np.hypot(*np.mgrid[-30:30, -40:40]) / 50
    write_depth_map(path, replace(depth_map, depth=(depth_map.depth * factor).astype(np.float32)), {})
    plain = finished.score()
    assert finished.score(**change) != plain


def test_a_sequence_named_a_can_is_compared_with_a_cylinder(finished):
    found = finished.score(params=EvaluateParams(surface_samples=2000, cylinder_sequences=("ring",)))
    assert found["cylinder_residual_median"] > 1  # a box is far from a cylinder


def test_without_truth_there_is_still_a_table(finished):
    none = dict.fromkeys(("masks_truth", "cameras_truth", "mesh_truth"))
    found = finished.score(**none)
    assert (
        set(found)
        == {"frames_posed", "path_continuity", "path_turns", "reprojection_error", "masks_cut_off"} | SOUNDNESS
    )


@pytest.mark.parametrize("scale", [1000.0, 5000.0])
def test_depth_images_in_metres(finished, scale):
    folder = finished.folder / "depth_truth"
    folder.mkdir()
    for path in finished.inputs["depth"]:
        # the scene is a quarter of the truth, and a working pixel two of the source
        depth = np.nan_to_num(read_depth_map(path).depth / 0.25).repeat(2, axis=0).repeat(2, axis=1)
        cv2.imwrite(
            str(folder / path.name.replace(".zarr.zip", ".depth.png")), np.rint(scale * depth).astype(np.uint16)
        )
    poses = json.loads(finished.inputs["poses"].read_text())
    finished.inputs["poses"].write_text(json.dumps({**poses, "distortion": [0.0, 0.0]}))
    found = finished.score(depth_truth=folder, depth_scale=scale)
    assert found["scene_depth_rmse"] < 5e-4  # half a millimetre of rounding
    assert found["scene_depth_covered"] == 100


def test_depth_images_of_other_frames_than_keyframes_are_left_out(finished):
    folder = finished.folder / "depth_of_others"
    folder.mkdir()
    (folder / "999999.depth.png").touch()
    names = finished.score(depth_truth=folder, depth_scale=1000.0)
    assert "frames_posed" in names and not any(name.startswith("scene_depth") for name in names)


def test_refuses_a_mask_of_the_wrong_size(finished):
    path = finished.inputs["masks_truth"] / "20.png"
    write_mask(path, read_mask(path)[::2, ::2])
    with pytest.raises(UserError, match=r"20.png: expected a mask of 160 x 120 pixels .* got 80 x 60"):
        finished.score()
    assert not (finished.folder / "metrics.csv").exists()


def test_refuses_masks_that_belong_to_no_frame(finished):
    folder = finished.folder / "other"
    write_mask(folder / "dragon.png", np.ones((120, 160), bool))
    with pytest.raises(UserError, match="expected masks named after frames"):
        finished.score(masks_truth=folder)


def test_a_mask_of_a_working_frame_is_compared_with_the_mesh_as_its_estimated_camera_sees_it(finished):
    """Exact: frame 110 is no keyframe; drawn with and without the true cameras, which it does not need."""
    mesh, views = (
        read_mesh(finished.inputs["mesh"]),
        {view.name: view for view in read_poses(finished.inputs["poses"]).views},
    )
    drawn = draw_source_silhouette(mesh, views["000110"], LENS, SOURCE)
    write_mask(finished.inputs["masks_truth"] / "110.png", drawn)
    found = finished.score()
    assert found["iou_frames"] == {"000110": 1.0} and found["iou_frames_mean"] == 1.0
    assert set(found["iou"]) == {*(f"{10 * number:06d}" for number in range(6)), "000110"}
    assert found["masks_without_keyframe"] == 1 and "masks_left_out" not in found
    assert "scored nowhere" not in finished.log.getvalue()
    alone = finished.score(cameras_truth=None, mesh_truth=None)
    assert alone["iou_frames"] == {"000110": 1.0}
    assert alone["masks_left_out"] == 2  # the unseen views need the true cameras


def test_a_method_without_a_mesh_is_scored_at_keyframes_alone(finished):
    folder = finished.inputs["masks_truth"]
    write_mask(folder / "000110.png", read_mask(folder / "20.png"))
    found = finished.score(mesh=None)
    assert len(found["iou"]) == 6 and "iou_frames" not in found and "iou_unseen" not in found
    assert found["masks_left_out"] == 3
    assert (
        "3 of 9 true masks are scored nowhere: 000110, between_0, between_1; without a mesh," in finished.log.getvalue()
    )


def test_masks_of_frames_that_were_not_worked_on_are_left_out_and_counted(finished):
    """Exact: of the frames between the working ones there is no camera; the rest is scored as without them."""
    before = finished.score()
    folder = finished.inputs["masks_truth"]
    for number in (5, 17):
        write_mask(folder / f"{number}.png", read_mask(folder / "20.png"))
    write_mask(folder / "cover.png", read_mask(folder / "20.png"))
    found = finished.score()
    assert found.pop("masks_left_out") == 3 and found.pop("masks_without_keyframe") == 3
    assert found == {name: value for name, value in before.items() if name != "masks_without_keyframe"}
    assert "3 of 11 true masks are scored nowhere: 000005, 000017, cover; no camera is known" in finished.log.getvalue()


def test_masks_of_such_frames_alone_are_no_error(finished):
    """Property: a truth may be of any frame of the video; that none can be scored is said."""
    folder = finished.folder / "between"
    write_mask(folder / "5.png", np.ones((120, 160), bool))
    found = finished.score(masks_truth=folder)
    assert found["masks_left_out"] == 1 and "iou_mean" not in found


def test_refuses_an_unreadable_mesh(finished):
    path = finished.folder / "broken.ply"
    path.write_text("ply\nnot a mesh")
    with pytest.raises(UserError, match=r"broken.ply: expected a triangle mesh"):
        finished.score(mesh_truth=path)


def test_refuses_cameras_of_other_frames(finished):
    content = json.loads(finished.inputs["cameras_truth"].read_text())
    for frame in content["frames"]:
        frame["video_frame"] = 5 + 10 * content["frames"].index(frame)
    path = finished.folder / "other.json"
    path.write_text(json.dumps(content))
    with pytest.raises(UserError, match="make the names agree"):
        finished.score(cameras_truth=path)


def test_masks_that_a_crop_cuts_off_are_counted(finished):
    """Exact: none of whole frames; one of a crop whose left side is within the object."""
    assert finished.score()["masks_cut_off"] == 0
    entries = read_keyframes(finished.inputs["crops"])
    masks = read_silhouettes(finished.inputs["silhouettes"])
    name, entry = next(iter(entries.items()))
    column = int(np.flatnonzero(masks[name].any(axis=0)).mean())
    camera = entry.view.camera
    cut = replace(camera, width=camera.width - column, cx=camera.cx - column)
    entries[name] = replace(entry, view=replace(entry.view, camera=cut))
    write_keyframes(finished.folder / "crops.json", list(entries.values()), {})
    masks[name] = masks[name][:, column:]
    write_silhouettes(finished.folder / "cut.zarr.zip", masks, {})
    found = finished.score(crops=finished.folder / "crops.json", silhouettes=finished.folder / "cut.zarr.zip")
    assert found["masks_cut_off"] == 1
    assert f"side of its crop in 1 of 6 keyframes, so a part of it may be missing: {name};" in finished.log.getvalue()
