"""The stage on artifacts of a plane of known depth."""

from __future__ import annotations

import numpy as np

from threedfs.geometry.similarity import Similarity
from threedfs.io.crops import Crop, write_crops
from threedfs.io.depth_maps import read_edges, read_semidense
from threedfs.io.keyframes import write_keyframes
from threedfs.io.points import write_points
from threedfs.io.poses import Poses, write_poses
from threedfs.job import Job
from threedfs.params.edges import EdgesParams
from threedfs.params.semidense import SemidenseParams
from threedfs.progress import Progress
from threedfs.stages import edges as edges_stage
from threedfs.stages import semidense as stage
from threedfs.types import SparsePoints


def test_stages_write_maps_of_the_keyframe(make_scene, tmp_path):
    """Oracle: the semi-dense map holds true depths of the named keyframe; its edge map is in [0, 1]."""
    scene = make_scene()
    views = [*scene.keyframe.neighbours, scene.keyframe.view]
    images = {**scene.images, "key": scene.image}
    everywhere = np.ones(scene.depth.shape, bool)
    crops = (Crop(view.name, images[view.name], everywhere) for view in views)
    write_crops(tmp_path / "c.zip", crops, {}, ordered=False, source_shape=scene.depth.shape)
    count = len(scene.sparse)
    sees = np.full(count, len(views) - 1)
    points = SparsePoints(scene.sparse, np.zeros((count, 3), np.uint8), np.zeros(count), np.arange(count), sees)
    write_points(tmp_path / "p.zip", points, {})
    poses = Poses(tuple(views), (), (0.0, 0.0), Similarity(1.0, np.eye(3), np.zeros(3)))
    write_poses(tmp_path / "p.json", poses, {})
    write_keyframes(tmp_path / "k.json", [scene.keyframe], {})
    inputs = {"crops": tmp_path / "c.zip", "keyframes": tmp_path / "k.json", "keyframe": "key"}
    job = Job(Progress("semidense"))

    stage.run(
        **inputs,
        poses=tmp_path / "p.json",
        points=tmp_path / "p.zip",
        semidense=tmp_path / "s.zip",
        params=SemidenseParams(),
        job=job,
    )
    inverse_depth = read_semidense(tmp_path / "s.zip").inverse_depth
    known = np.isfinite(inverse_depth)
    assert known.mean() > 0.35
    assert np.mean(np.abs(1 / inverse_depth[known] / scene.depth[known] - 1) < 0.02) > 0.98

    edges_stage.run(**inputs, edges=tmp_path / "e.zip", params=EdgesParams(), job=job)
    strength = read_edges(tmp_path / "e.zip")
    assert strength.shape == scene.depth.shape and strength.min() >= 0 and strength.max() == 1
