"""Find the metric scale of a sequence: by a tag or a checkerboard in the scene, or by the object's known height."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from threedfs.errors import UserError
from threedfs.frames.calibrate import find_board
from threedfs.geometry.lens import Lens
from threedfs.io.frames import read_frames
from threedfs.io.meshes import read_mesh
from threedfs.io.poses import Poses, read_poses
from threedfs.io.scales import Scale, write_scale
from threedfs.io.volumes import read_support
from threedfs.job import Job
from threedfs.object.stand import height_on
from threedfs.params.scale import ScaleParams
from threedfs.scale.board import align_boards, board_places
from threedfs.scale.measure import Measurement, choose_tag, measure_pattern
from threedfs.scale.tags import CORNERS, find_tags


def run(
    *,
    frames: Path | None,
    poses: Path | None,
    mesh: Path | None,
    support: Path | None,
    scale: Path,
    known: Mapping[str, Any],
    params: ScaleParams,
    job: Job,
) -> None:
    """Write scale.json.

    Parameters
    ----------
    frames, poses : Path or None
        For a tag or a board.
    mesh, support : Path or None
        For a height.
    known : mapping
        `source` (tag, board or height), `length` (metres) and, of a board, `corners`, of a height, the `method` of
        the mesh.

    Raises
    ------
    UserError
        If too few frames see the tag or the board, or its distances disagree.
    """
    if known["source"] == "height":
        assert mesh is not None and support is not None  # the rule gives what the source needs
        height = height_on(read_mesh(mesh), read_support(support).plane)
        found = Scale(known["length"] / height, None, "height", known["length"], 0, known["method"])
    else:
        assert frames is not None and poses is not None
        find = _measure_tag if known["source"] == "tag" else _measure_board
        result, detail = find(_Scene(frames, read_poses(poses)), known, params, job)
        found = Scale(result.scale, result.spread, known["source"], known["length"], result.frames, detail)
    write_scale(scale, found, job.header)
    job.progress.note(f"a scene unit is {1000 * found.metres_per_unit:.2f} mm, by {found.source} {found.detail}")


class _Scene:
    """The posed frames, as filmed, with their lenses."""

    def __init__(self, frames: Path, poses: Poses) -> None:
        self.store = read_frames(frames)
        self.lenses = {view.name: Lens(view.camera, *poses.distortion) for view in poses.views}
        self.cam_from_world = {view.name: view.cam_from_world for view in poses.views}


def _measure_tag(scene: _Scene, known: Mapping[str, Any], params: ScaleParams, job: Job) -> tuple[Measurement, str]:
    seen: dict[str, dict[str, np.ndarray]] = {}
    for frame in job.progress.track(scene.lenses, "frame", len(scene.lenses)):
        for tag, corners in find_tags(scene.store.image(frame), params.window).items():
            seen.setdefault(tag, {})[frame] = corners
    places = known["length"] * CORNERS
    measured = {
        tag: result
        for tag, views in sorted(seen.items())
        if (result := measure_pattern(views, places, scene.lenses, scene.cam_from_world)) is not None
    }
    chosen = choose_tag(measured, params.min_frames, params.max_spread)
    if not chosen:
        _refuse(
            f"an ArUco or AprilTag marker of {1000 * known['length']:g} mm",
            {tag: (len(views), measured.get(tag)) for tag, views in seen.items()},
            params,
            "print it with a white margin, lay it flat beside the object, and film it larger, from several sides",
        )
    best = measured[chosen[0]]
    for tag in chosen[1:]:
        if abs(measured[tag].scale / best.scale - 1) > params.max_spread:
            raise UserError(
                f"scale: expected tags of one size, found {chosen[0]} and {tag}, whose sides are as 1 to "
                f"{best.scale / measured[tag].scale:.2f}; leave only those of {1000 * known['length']:g} mm in the "
                "scene."
            )
    return best, chosen[0]


def _measure_board(scene: _Scene, known: Mapping[str, Any], params: ScaleParams, job: Job) -> tuple[Measurement, str]:
    board = tuple(known["corners"])
    corners = {}
    for frame in job.progress.track(scene.lenses, "frame", len(scene.lenses)):
        found = find_board(scene.store.image(frame), board, params.window)
        if found is not None:
            corners[frame] = found
    seen = align_boards(corners, board, scene.lenses, scene.cam_from_world)
    detail = f"{board[0]}x{board[1]} corners"
    result = measure_pattern(seen, known["length"] * board_places(board), scene.lenses, scene.cam_from_world)
    if result is None or result.frames < params.min_frames or result.spread > params.max_spread:
        _refuse(
            f"a checkerboard of {board[0]}x{board[1]} inner corners",
            {"the board": (len(seen), result)} if seen else {},
            params,
            "count the corners between the squares, not the squares, keep the whole board flat and in view, and film "
            "it from several sides",
        )
    return result, detail


def _refuse(
    what: str, found: Mapping[str, tuple[int, Measurement | None]], params: ScaleParams, advice: str
) -> NoReturn:
    """Say what was found instead: the thing that most frames see."""
    said = "found none"
    if found:
        name, (count, result) = max(found.items(), key=lambda item: (item[1][0], item[0]))
        spread = "" if result is None else f" with distances that disagree by {100 * result.spread:.1f} %"
        said = f"found {name} in {count}{spread}"
    raise UserError(
        f"scale: expected {what} in at least {params.min_frames} frames, its distances right to "
        f"{100 * params.max_spread:g} %, {said}; {advice}."
    )
