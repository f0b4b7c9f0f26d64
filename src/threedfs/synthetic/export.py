"""Writing a film with its truth into a folder."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from threedfs.geometry.rigid import invert
from threedfs.io.atomic import atomic
from threedfs.io.images import write_depth_image, write_mask
from threedfs.io.meshes import write_mesh
from threedfs.progress import Progress
from threedfs.synthetic.film import Film, map_forked, shoot_all
from threedfs.synthetic.render import Renderer
from threedfs.synthetic.takes import DEPTH_SCALE
from threedfs.synthetic.video import write_video
from threedfs.types import View


@dataclass(frozen=True)
class FilmFiles:
    """Where the parts of a film go: files `video`, `cameras`, `mesh`, folders `masks` and, if wanted, `depth`."""

    video: Path
    cameras: Path
    mesh: Path
    masks: Path
    depth: Path | None = None

    @classmethod
    def below(cls, folder: Path, depth: bool) -> FilmFiles:
        """Name them in one folder."""
        named = (folder / name for name in ("video.mp4", "cameras.json", "mesh.ply", "masks"))
        return cls(*named, folder / "depth" if depth else None)


def write_film(
    files: FilmFiles,
    film: Film,
    renderer: Renderer,
    *,
    unseen: Sequence[View] = (),
    mask_step: int,
    quality: int,
    processes: int,
    progress: Progress,
) -> None:
    """Render a film and write it with its truth; the bytes do not depend on the number of processes.

    Masks are `<frame>.png` or `<view>.png`, depth images `<frame>.depth.png`, 16 bit in 1 / `DEPTH_SCALE` units,
    0 where there is none.

    Parameters
    ----------
    files : FilmFiles
        Files that are there are replaced.
    film : Film
    renderer : Renderer
        Of the film's scene.
    unseen : sequence of View
        More views, of which no image but a camera and a mask is written.
    mask_step : int
        Every so many frames a mask and a depth image is written.
    quality : int
        Constant rate factor of the video.
    processes : int
        How many render.
    progress : Progress
    """
    write_cameras(files.cameras, film, unseen)
    write_mesh(files.mesh, film.scene.solid.mesh)
    filmed = [film.view(frame) for frame in range(0, film.frames, mask_step)]

    def write_truth(view: View) -> None:
        depth, mask = renderer.measure(view)
        write_mask(files.masks / f"{view.name}.png", mask)
        if files.depth is not None and view.name not in names_unseen:
            write_depth_image(files.depth / f"{view.name}.depth.png", depth, DEPTH_SCALE)

    names_unseen = {view.name for view in unseen}
    views = [*filmed, *unseen]
    for _ in progress.track(map_forked(write_truth, views, processes), "mask", len(views)):
        pass
    images = progress.track(shoot_all(film, renderer, processes), "frame", film.frames)
    with atomic(files.video) as temporary:
        write_video(temporary, images, film.rate, quality)


def write_cameras(path: Path, film: Film, unseen: Sequence[View] = ()) -> None:
    """Write the camera of every frame, then those of unseen views, as JSON.

    Pixels are those of COLMAP: (0.5, 0.5) is the first one's centre. Only frames have the key `video_frame`.
    """
    camera = film.camera
    frames = [
        {
            "name": f"{frame:06d}",
            "video_frame": frame,
            "cam_to_world": _cam_to_world(film.view(frame)),
        }
        for frame in range(film.frames)
    ]
    frames += [{"name": view.name, "cam_to_world": _cam_to_world(view)} for view in unseen]
    content = {
        "width": camera.width,
        "height": camera.height,
        "fx": camera.fx,
        "fy": camera.fy,
        "cx": camera.cx + 0.5,
        "cy": camera.cy + 0.5,
        "k1": 0.0,
        "distortion_model": "COLMAP SIMPLE_RADIAL: x_d = x*(1+k1*r^2)",
        "pose_convention": "cam_to_world 4x4, OpenCV camera axes (x right, y down, z forward); "
        "pixel (0.5, 0.5) = centre of the top-left pixel; scene units are metres",
    }
    lines = ",\n".join("  " + json.dumps(frame) for frame in frames)
    text = json.dumps(content, indent=1)[:-2] + ',\n "frames": [\n' + lines + "\n ]\n}\n"
    with atomic(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def _cam_to_world(view: View) -> list[list[float]]:
    return np.round(invert(view.cam_from_world), 12).tolist()
