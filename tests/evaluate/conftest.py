"""A small finished run on disk: a box seen by a ring of cameras, every result exact."""

import io
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from threedfs.evaluate.rendering import MeshRenderer, image_points
from threedfs.geometry.rigid import invert, look_at
from threedfs.geometry.similarity import Similarity
from threedfs.io.depth_maps import DepthMap, write_depth_map
from threedfs.io.frames import Frame, write_frames
from threedfs.io.images import write_mask
from threedfs.io.keyframes import write_keyframes
from threedfs.io.meshes import write_mesh
from threedfs.io.metrics import read_metrics
from threedfs.io.poses import Poses, write_poses
from threedfs.io.volumes import write_silhouettes
from threedfs.job import Job
from threedfs.object.silhouettes import draw_silhouette, draw_source_silhouette
from threedfs.params.evaluate import EvaluateParams
from threedfs.params.evaluate_reconstruction import EvaluateReconstructionParams
from threedfs.progress import Progress
from threedfs.stages import evaluate, evaluate_reconstruction
from threedfs.types import Camera, Keyframe, Mesh, View

SOURCE = (120, 160)
LENS = (0.08, 0.01)
TRUE_CAMERA = Camera(SOURCE[1], SOURCE[0], 150.0, 150.0, 79.5, 59.5)
QUALITY = {"step_ratio": 1.5, "turns": 0.75, "reprojection_error": 0.4}
WORKING = Camera(80, 60, 75.0, 75.0, 39.5, 29.5)
SCENE_FROM_TRUTH = Similarity(0.25, Rotation.from_rotvec([0.2, 1.0, -0.4]).as_matrix(), np.array([1.0, -2, 0.5]))


@dataclass
class Run:
    """Paths of a run, and what its log said."""

    inputs: dict
    folder: Path
    log: io.StringIO

    def score(self, **changes):
        """Run both stages; return the figures by name, those of frames as mappings."""
        given = {**self.inputs, "depth_scale": 1000.0, "depth_camera": None, "intrinsics": None, **changes}
        shared = ("poses", "keyframes", "frames", "cameras_truth", "mesh_truth", "intrinsics")
        calls = {
            "reconstruction.csv": (evaluate_reconstruction, ("depth", "depth_truth", "depth_scale", "depth_camera")),
            "metrics.csv": (evaluate, ("mesh", "masks", "silhouettes", "crops", "masks_truth")),
        }
        params = {
            "reconstruction.csv": changes.get("reconstruction", EvaluateReconstructionParams()),
            "metrics.csv": changes.get("params", EvaluateParams(surface_samples=2000)),
        }
        found = {}
        for name, (stage, own) in calls.items():
            labels = {"dataset": "box", "sequence": "ring"}
            labels |= {"method": "fused_sdf"} if stage is evaluate else {}
            stage.run(
                **{key: given[key] for key in (*shared, *own)},
                **labels,
                metrics=self.folder / name,
                params=params[name],
                job=Job(Progress("evaluate", self.log)),
            )
            self._gather(name, labels, found)
        return found

    def _gather(self, name, labels, found):
        for metric in read_metrics(self.folder / name):
            own = (metric.dataset, metric.sequence, metric.method)
            assert own == (labels["dataset"], labels["sequence"], labels.get("method", ""))
            if metric.keyframe:
                found.setdefault(metric.name, {})[metric.keyframe] = metric.value
            else:
                assert metric.name not in found
                found[metric.name] = metric.value


def box():
    made = trimesh.creation.box(extents=(1.0, 0.8, 1.4)).subdivide().subdivide()
    return Mesh(np.asarray(made.vertices, np.float64), np.asarray(made.faces, np.int64))


@pytest.fixture
def finished(tmp_path):
    """Twelve video frames in steps of 10, the first six keyframes; masks of those and of two views between frames."""
    truth = box()
    mesh = Mesh(SCENE_FROM_TRUTH.apply(truth.vertices), truth.faces)
    angles = np.linspace(0, 1.5 * np.pi, 12)
    poses = [_ring_pose(angle) for angle in angles]
    names = [f"{10 * number:06d}" for number in range(12)]
    views = [View(name, WORKING, SCENE_FROM_TRUTH.apply_to_pose(pose)) for name, pose in zip(names, poses, strict=True)]
    unseen = {f"between_{number}": _ring_pose(angles[number] + 0.2) for number in range(2)}

    frames = (Frame(name, int(name), int(name) / 30, 1.0, np.zeros((60, 80, 3), np.uint8)) for name in names)
    write_frames(tmp_path / "frames.zarr.zip", frames, {}, ordered=True, source_shape=SOURCE)
    identity = Similarity(1.0, np.eye(3), np.zeros(3))
    write_poses(tmp_path / "poses.json", Poses(tuple(views), (), LENS, identity, quality=QUALITY), {})
    write_keyframes(tmp_path / "keyframes.json", [Keyframe(view, (), 0.1, 2.0) for view in views[:6]], {})
    write_mesh(tmp_path / "mesh.ply", mesh)
    write_mesh(tmp_path / "truth.ply", truth)
    write_silhouettes(tmp_path / "silhouettes.zarr.zip", {v.name: draw_silhouette(mesh, v) for v in views[:6]}, {})
    renderer = MeshRenderer(mesh)
    maps = []
    for view, pose in zip(views[:6], poses, strict=False):
        depth = renderer.depth(view.cam_from_world, image_points(WORKING, (0.0, 0.0))).astype(np.float32)
        nothing = np.zeros_like(depth)
        maps.append(tmp_path / "depth" / f"{view.name}.zarr.zip")
        write_depth_map(maps[-1], DepthMap(depth, nothing, nothing), {})
        write_mask(tmp_path / "masks" / f"{view.name}.png", draw_source_silhouette(mesh, view, LENS, SOURCE))
        drawn = draw_source_silhouette(truth, View(view.name, TRUE_CAMERA, pose), LENS, SOURCE)
        write_mask(tmp_path / "masks_truth" / f"{int(view.name)}.png", drawn)
    for name, pose in unseen.items():
        drawn = draw_source_silhouette(truth, View(name, TRUE_CAMERA, pose), LENS, SOURCE)
        write_mask(tmp_path / "masks_truth" / f"{name}.png", drawn)
    entries = [
        {"name": name, "video_frame": int(name), "cam_to_world": invert(pose).tolist()}
        for name, pose in zip(names, poses, strict=True)
    ]
    entries += [{"name": name, "cam_to_world": invert(pose).tolist()} for name, pose in unseen.items()]
    lens = {"width": 160, "height": 120, "fx": 150, "fy": 150, "cx": 80, "cy": 60, "k1": LENS[0], "k2": LENS[1]}
    (tmp_path / "cameras.json").write_text(json.dumps({**lens, "frames": entries}))
    inputs = {
        "poses": tmp_path / "poses.json",
        "keyframes": tmp_path / "keyframes.json",
        "mesh": tmp_path / "mesh.ply",
        "masks": tmp_path / "masks",
        "silhouettes": tmp_path / "silhouettes.zarr.zip",
        "crops": tmp_path / "keyframes.json",
        "depth": maps,
        "frames": tmp_path / "frames.zarr.zip",
        "masks_truth": tmp_path / "masks_truth",
        "cameras_truth": tmp_path / "cameras.json",
        "mesh_truth": tmp_path / "truth.ply",
        "depth_truth": None,
    }
    return Run(inputs, tmp_path, io.StringIO())


def _ring_pose(angle):
    centre = 4 * np.array([np.cos(angle), np.sin(angle), 0.5])
    return look_at(centre, np.zeros(3), np.array([0, 0, 1.0]))
