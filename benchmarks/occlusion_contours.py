"""Contours against borders where one thing hides another, or itself, on renders that the forest was not trained on.

    python benchmarks/occlusion_contours.py [--renders 32]

`contours.py` counts creases and sheets as well. Here these are left out of the count: a contour found on one is neither
right nor wrong. Prints ODS and OIS of the structured forest, the gradient, and Canny's detector by its smoothing.
"""

from __future__ import annotations

import argparse
from typing import Any
from unittest.mock import patch

import numpy as np
from command import run_command
from contours import LEVELS, SMOOTHINGS, VIEWS, canny, gradient, whole
from skimage.morphology import skeletonize

from threedfs.edges.structured import structured_contours
from threedfs.edges.thin import thin
from threedfs.edges.training import renders
from threedfs.edges.training.picture import Picture, contour_pixels
from threedfs.edges.training.train import held_out_renders
from threedfs.evaluate.contours import TOLERANCE, ContourCounts, match_contours, score_contours
from threedfs.io.contour_forest import read_forest
from threedfs.synthetic.render import pixel_rays


def mark_occlusions(renderer: Any, parts: Any, view: Any) -> np.ndarray:
    """Return (H, W) bool: pixels whose right or lower neighbour is of another thing, or a step in depth away.

    The table with what lies flat on it is one thing, the room another, and so is each thing of the still life.
    """
    depth, on_object = renderer.measure(view)
    origins, directions = pixel_rays(view)
    points = origins + depth.reshape(-1, 1) * directions
    surface, normals = renders._name_surfaces(renderer.scene, points, on_object.ravel())
    rows = np.flatnonzero(on_object)
    normals[rows] = renders._normals_of(parts, renderer.scene.solid, points[rows])
    thing = np.where(surface >= 100, surface, surface >= 10).reshape(depth.shape)
    points, normals = points.reshape(*depth.shape, 3), normals.reshape(*depth.shape, 3)
    marked = np.zeros(depth.shape, bool)
    for one, other in ((np.s_[:, :-1], np.s_[:, 1:]), (np.s_[:-1], np.s_[1:])):
        step = points[other] - points[one]
        apart = np.minimum(np.abs((step * normals[one]).sum(-1)), np.abs((step * normals[other]).sum(-1)))
        marked[one] |= (thing[one] != thing[other]) | (apart >= renders._JUMP)
    return marked


def render_occlusions(count: int) -> tuple[list[Picture], list[np.ndarray]]:
    """Render still lifes that the forest was not trained on, with the occlusions (H, W) bool of each picture."""
    occlusions, link = [], renders._link

    def mark_and_link(*scene: Any) -> list[np.ndarray]:
        occlusions.append(mark_occlusions(*scene))
        return link(*scene)

    with patch.object(renders, "_link", mark_and_link):
        pictures = held_out_renders(-(-count // VIEWS), VIEWS, 320)
    return pictures, occlusions


def count_occlusions(
    strength: np.ndarray, occlusions: np.ndarray, contours: np.ndarray, thresholds: np.ndarray
) -> ContourCounts:
    """Match thin contours with occlusions (H, W) bool; leave out what is found on other contours (H, W) bool."""
    distance = TOLERANCE * float(np.hypot(*strength.shape))
    rows = []
    for threshold in thresholds:
        found = strength >= threshold
        right, recalled = match_contours(found, occlusions, distance)
        elsewhere, _ = match_contours(found & ~right, contours & ~occlusions, distance)
        rows.append((found.sum() - elsewhere.sum(), right.sum(), occlusions.sum(), recalled.sum()))
    return ContourCounts(*np.array(rows, np.int64).T)


def main() -> None:
    """Render, and print a row of each method."""
    parser = argparse.ArgumentParser(description="Score detectors of contours where one thing hides another.")
    parser.add_argument("--renders", type=int, default=32)
    pictures, occlusions = render_occlusions(parser.parse_args().renders)
    # as thin as the contours of people, or a staircase would count twice
    truths = [
        (skeletonize(own), skeletonize(contour_pixels(picture)))
        for picture, own in zip(pictures, occlusions, strict=True)
    ]
    forest = read_forest()
    detectors = {
        "structured": (
            lambda image: thin(structured_contours(image, whole(image), forest)),
            np.arange(1, 16) / 15 * 0.3,
        ),
        "gradient": (lambda image: thin(gradient(image)), np.arange(1, 16) / 15),
    }
    for by in SMOOTHINGS:
        detectors[f"canny {by}"] = lambda image, by=by: canny(image, by), np.arange(1, len(LEVELS) + 1) / len(LEVELS)
    for method, (detect, thresholds) in detectors.items():
        counts = [
            count_occlusions(detect(picture.image), *truth, thresholds)
            for picture, truth in zip(pictures, truths, strict=True)
        ]
        found = score_contours(counts, thresholds)
        print(f"{method:10}  ODS {found.ods:.3f}  OIS {found.ois:.3f}", flush=True)


if __name__ == "__main__":
    run_command(main)
