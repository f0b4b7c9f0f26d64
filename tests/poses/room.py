"""Pictures of a textured box on a textured floor, by casting a ray through every pixel centre."""

from __future__ import annotations

import cv2
import numpy as np

from threedfs.geometry.lens import Lens
from threedfs.geometry.rigid import look_at
from threedfs.types import Camera

LENS = Lens(Camera(320, 240, 330.0, 330.0, 159.5, 119.5))
LOW, HIGH = np.array([-0.4, -0.4, 0.0]), np.array([0.4, 0.4, 0.7])


def make_texture(seed: int) -> np.ndarray:
    """Return a (256, 256) float32 texture with detail at several scales."""
    rng = np.random.default_rng(seed)
    layers = [
        cv2.resize(rng.uniform(0, 1, (n, n)).astype(np.float32), (256, 256), interpolation=cv2.INTER_CUBIC)
        for n in (12, 40, 110)
    ]
    return np.clip(255 * sum(layers) / 3, 0, 255)


TEXTURES = [make_texture(seed) for seed in range(4)]


def render(pose: np.ndarray) -> np.ndarray:
    """Return the (H, W, 3) uint8 picture that a camera at cam_from_world `pose` takes."""
    camera = LENS.camera
    v, u = np.mgrid[: camera.height, : camera.width].astype(np.float64)
    rays = np.stack([(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, np.ones_like(u)], axis=-1) @ pose[:3, :3]
    centre = -pose[:3, :3].T @ pose[:3, 3]
    with np.errstate(divide="ignore", invalid="ignore"):
        floor = -centre[2] / rays[..., 2]
        slabs = np.stack([(LOW - centre) / rays, (HIGH - centre) / rays])
    entry = slabs.min(0)
    near, far, side = entry.max(-1), slabs.max(0).min(-1), entry.argmax(-1)
    hit = (near < far) & (near > 0)
    at = centre + np.where(hit, near, np.where(floor > 0, floor, 50.0))[..., None] * rays
    kind = np.where(hit, side, 3)
    image = np.zeros(u.shape, np.float32)
    for index, axes in enumerate(((1, 2), (0, 2), (0, 1), (0, 1))):
        scale = 60.0 if index == 3 else 250.0
        where = (at[..., axes] * scale + 1000).astype(np.float32)
        # Opposite sides of the box differ: the texture goes on from one to the other.
        if index < 3:
            where[..., 0] += 97.0 * (at[..., index] > 0.1)
        color = cv2.remap(TEXTURES[index], where[..., 0] % 255, where[..., 1] % 255, cv2.INTER_LINEAR)
        image = np.where(kind == index, color, image)
    return np.repeat(np.rint(image).astype(np.uint8)[..., None], 3, axis=2)


def walk(frames: int, angle: float) -> list[np.ndarray]:
    """Return the poses of a walk around the box over an angle in radians."""
    target = np.array([0, 0, 0.25])
    turns = np.linspace(0.3, 0.3 + angle, frames)
    centres = [np.array([2.0 * np.cos(t), 2.0 * np.sin(t), 1.1 + 0.15 * np.sin(3 * t)]) for t in turns]
    return [look_at(centre, target, np.array([0, 0, 1.0])) for centre in centres]
