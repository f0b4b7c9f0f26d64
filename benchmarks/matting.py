"""How far soft masks are from the exact coverage of pixels: closed-form matting beside masks, blurred or not.

    python benchmarks/matting.py [SAMPLES]

A pixel's coverage is the share of SAMPLES x SAMPLES rays (5) that meet the object. Images average the same rays. Masks
are the exact ones, and such as are wrong by a pixel or two. Errors are over the pixels within 8 of the outline, mean
and root of the mean square, in levels of 255.
"""

from __future__ import annotations

import sys
import time
from dataclasses import replace

import cv2
import numpy as np

from threedfs.matting.closed_form import BAND, EPSILON, TRUST, matte_outline
from threedfs.segment.outline import depth_inside
from threedfs.synthetic.film import Film
from threedfs.synthetic.render import Renderer
from threedfs.synthetic.sample import sample_film
from threedfs.synthetic.takes import make_take
from threedfs.types import View

_AROUND = 8
_TAKES = ("sample", "dragon", "hedgehog2")


def shoot(film: Film, renderer: Renderer, frame: int, samples: int) -> tuple[np.ndarray, np.ndarray]:
    """Return a frame (H, W, 3) uint8 at rest, and the exact coverage (H, W) float64 of the object."""
    view, light, cover = film.view(frame), 0.0, 0.0
    steps = (np.arange(samples) + 0.5) / samples - 0.5
    for u in steps:
        for v in steps:
            camera = replace(view.camera, cx=view.camera.cx - u, cy=view.camera.cy - v)
            light = light + renderer.radiance(view, (u, v))
            cover = cover + renderer.mask(View("", camera, view.cam_from_world))
    return film.sensor.record(light / samples**2, frame, film.time(frame)), cover / samples**2


def disturb(mask: np.ndarray) -> dict[str, np.ndarray]:
    """Return masks by what is wrong with them."""
    cross = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (3, 3))
    plain = mask.astype(np.uint8)
    grown = {f"{n} px wide": cv2.dilate(plain, cross, iterations=n) > 0 for n in (1, 2)}
    shrunk = {f"{n} px narrow": cv2.erode(plain, cross, iterations=n) > 0 for n in (1, 2)}
    return {"exact": mask, **grown, **shrunk, "1 px aside": np.roll(mask, 1, axis=1)}


def blur(mask: np.ndarray) -> np.ndarray:
    """Return a mask softened over the pixel at its outline, which needs no image."""
    return cv2.GaussianBlur(mask.astype(np.float64), (0, 0), 0.6)


def measure(difference: np.ndarray, near: np.ndarray) -> tuple[float, float]:
    """Return the mean and the root of the mean square of an error (H, W) over some pixels, levels of 255."""
    return 255 * np.abs(difference[near]).mean(), 255 * np.sqrt((difference[near] ** 2).mean())


def main() -> None:
    """Print a table for each take, two frames of it."""
    samples = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    for name in _TAKES:
        film = sample_film() if name == "sample" else make_take(name).film(120, 640, 4)
        renderer = Renderer(film.scene)
        shots = [shoot(film, renderer, frame, samples) for frame in (0, film.frames // 2)]
        print(f"{name}: mean and rms error of opacity, of 255; band {BAND} px, epsilon {EPSILON:g}, trust {TRUST:g}")
        for wrong in disturb(shots[0][1] > 0.5):
            errors, seconds = [], 0.0
            for image, cover in shots:
                mask = disturb(cover > 0.5)[wrong]
                near = np.abs(depth_inside(cover > 0.5)) <= _AROUND
                start = time.perf_counter()
                soft = matte_outline(image, mask)
                seconds += time.perf_counter() - start
                errors.append([measure(guess - cover, near) for guess in (mask, blur(mask), soft)])
            told = "   ".join(
                f"{what} {mean:5.1f} {root:5.1f}"
                for what, (mean, root) in zip(("mask", "blurred", "matting"), np.mean(errors, axis=0), strict=True)
            )
            print(f"  {wrong:12}  {told}   {seconds / len(shots):.2f} s")


if __name__ == "__main__":
    main()
