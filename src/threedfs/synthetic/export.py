"""Writing a film with its truth into a folder."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from threedfs.geometry.rigid import invert
from threedfs.io.atomic import atomic
from threedfs.io.images import write_mask
from threedfs.io.meshes import write_mesh
from threedfs.progress import Progress
from threedfs.synthetic.film import Film, shoot_all
from threedfs.synthetic.render import Renderer
from threedfs.synthetic.video import write_video


def write_film(folder: Path, film: Film, mask_step: int, quality: int, processes: int, progress: Progress) -> None:
    """Render a film and write `video.mp4`, `cameras.json`, `mesh.ply` and `masks/<frame>.png`.

    Parameters
    ----------
    folder : Path
        Made if absent; files in it are replaced.
    film : Film
    mask_step : int
        Every so many frames one mask is written.
    quality : int
        Constant rate factor of the video.
    processes : int
        How many render; the bytes do not depend on it.
    progress : Progress
    """
    renderer = Renderer(film.scene)
    write_cameras(folder / "cameras.json", film)
    write_mesh(folder / "mesh.ply", film.scene.solid.mesh)
    for frame in range(0, film.frames, mask_step):
        write_mask(folder / "masks" / f"{frame:06d}.png", renderer.mask(film.view(frame)))
    images = progress.track(shoot_all(film, renderer, processes), "frame", film.frames)
    with atomic(folder / "video.mp4") as temporary:
        write_video(temporary, images, film.rate, quality)


def write_cameras(path: Path, film: Film) -> None:
    """Write the camera of every frame as JSON, in COLMAP's pixels: (0.5, 0.5) is the first pixel's centre."""
    camera = film.camera
    frames = [
        {
            "name": f"{frame:06d}",
            "video_frame": frame,
            "cam_to_world": np.round(invert(film.view(frame).cam_from_world), 12).tolist(),
        }
        for frame in range(film.frames)
    ]
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
