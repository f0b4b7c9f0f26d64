"""Small inputs of every kind that are sound, to be spoilt one by one."""

from __future__ import annotations

import json
from pathlib import Path

import av
import numpy as np
import trimesh
from PIL import Image

from threedfs.geometry.rigid import invert, look_at

COUNT, ROWS, COLUMNS = 12, 48, 64
LENS = {"width": COLUMNS, "height": ROWS, "fx": 60.0, "fy": 60.0, "cx": 32.0, "cy": 24.0}


def write_video(path: Path) -> Path:
    """Write a video of noise."""
    generator = np.random.default_rng(0)
    with av.open(str(path), "w") as container:
        stream = container.add_stream("mpeg4", rate=10)
        stream.width, stream.height, stream.pix_fmt = COLUMNS, ROWS, "yuv420p"
        for _ in range(COUNT):
            image = generator.integers(0, 255, (ROWS, COLUMNS, 3), dtype=np.uint8)
            container.mux(stream.encode(av.VideoFrame.from_ndarray(image, format="rgb24")))
        container.mux(stream.encode())
    return path


def cameras() -> dict:
    """Return the content of cameras.json: a circle of cameras around the origin."""
    frames = []
    for number in range(COUNT):
        angle = 0.4 * number
        centre = 5 * np.array([np.cos(angle), np.sin(angle), 0.5])
        pose = look_at(centre, np.zeros(3), np.array([0.0, 0.0, 1.0]))
        frames.append({"name": f"{number:06d}", "video_frame": number, "cam_to_world": invert(pose).tolist()})
    return {**LENS, "frames": frames}


def write_mask(path: Path, mask: np.ndarray, levels: int = 255, kind: type = np.uint8) -> None:
    """Write a mask with a level for its object."""
    path.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(mask.astype(kind) * kind(levels)).save(path)


def disc(radius: float = 12.0) -> np.ndarray:
    """Return what the cameras see of a ball in the origin, nearly."""
    rows, columns = np.mgrid[:ROWS, :COLUMNS]
    return np.hypot(columns - 31.5, rows - 23.5) < radius


def write_sound(folder: Path) -> Path:
    """Write a video, photos, cameras, masks, a mesh and depth images that belong to each other; return the folder."""
    write_video(folder / "video.mp4")
    (folder / "photos").mkdir()
    generator = np.random.default_rng(1)
    for number in range(COUNT):
        image = generator.integers(0, 255, (ROWS, COLUMNS, 3), dtype=np.uint8)
        Image.fromarray(image).save(folder / f"photos/{number:06d}.png")
        write_mask(folder / f"masks/{number:06d}.png", disc())
        (folder / "depth").mkdir(exist_ok=True)
        depth = np.full((ROWS, COLUMNS), 5000, np.uint16)
        Image.fromarray(depth).save(folder / f"depth/{number:06d}.depth.png")
    (folder / "cameras.json").write_text(json.dumps(cameras()))
    trimesh.creation.icosphere(radius=1.1).export(folder / "mesh.ply")
    return folder
