"""Contours against human ones, against the borders of rendered things, and their cost.

    python benchmarks/contours.py FOLDER [--images 100] [--renders 32] [--csv rows.csv]

FOLDER holds `images/NAME.jpg` and `groundTruth/NAME.mat` as the BSDS benchmark has them. Prints ODS and OIS of the
structured forest, the gradient, and Canny's detector with the smoothing that suits it best; the same on still lifes
that the forest was not trained on; then seconds of one core for an image of 640x480.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
from command import run_command
from scipy.io import loadmat
from skimage.morphology import skeletonize

from threedfs.edges.multiscale import multiscale_gradient
from threedfs.edges.structured import structured_contours
from threedfs.edges.thin import thin
from threedfs.edges.training.picture import contour_pixels
from threedfs.edges.training.train import held_out_renders
from threedfs.errors import UserError
from threedfs.evaluate.contours import ContourScores, count_matches, score_contours
from threedfs.evaluate.scores import Metric
from threedfs.io.contour_forest import read_forest
from threedfs.io.metrics import write_metrics
from threedfs.params.edges import EdgesParams

SMOOTHINGS = (1.5, 2.0, 2.5, 3.0, 3.5)
LEVELS = np.geomspace(25, 250, 10)
VIEWS = 2
"""Of each still life: more scenes say more than more views."""
Truths = list[tuple[np.ndarray, list[np.ndarray]]]


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--images", type=int, default=100)
    parser.add_argument("--renders", type=int, default=32)
    parser.add_argument("--csv", type=Path, help="write the rows of docs/results.csv")
    options = parser.parse_args()
    cv2.setNumThreads(1)
    human = read_truths(options.folder, options.images)
    print(f"{len(human)} images of {options.folder.name}")
    scores = compare(human)
    rows = [
        Metric(name, getattr(found, name), "1", "bsds500_val", "", method)
        for method, found in scores.items()
        for name in ("ods", "ois")
    ]
    if options.csv:
        write_metrics(options.csv, rows)
    renders = held_out_renders(-(-options.renders // VIEWS), VIEWS, 320)
    print(f"{len(renders)} renders")
    # as thin as the contours of people, or a staircase would count twice
    compare([(picture.image, [skeletonize(contour_pixels(picture))]) for picture in renders])
    print_costs()


def read_truths(folder: Path, count: int) -> Truths:
    """Read images evenly spread over a folder, each with the contours of its annotators."""
    names = sorted(path.stem for path in (folder / "groundTruth").glob("*.mat"))
    if not names:
        raise UserError(f"{folder}: expected groundTruth/NAME.mat and images/NAME.jpg, found no truth.")
    truths = []
    for index in np.unique(np.linspace(0, len(names) - 1, min(count, len(names))).round().astype(int)):
        image = cv2.imread(str(folder / "images" / f"{names[index]}.jpg"))
        marked = loadmat(folder / "groundTruth" / f"{names[index]}.mat")["groundTruth"][0]
        truths.append((np.ascontiguousarray(image[..., ::-1]), [one["Boundaries"][0, 0] > 0 for one in marked]))
    return truths


def compare(truths: Truths) -> dict[str, ContourScores]:
    """Score the methods and print a row of each."""
    forest = read_forest()
    scores = {
        "structured": score(lambda image: thin(structured_contours(image, whole(image), forest)), truths, 0.3),
        "gradient": score(lambda image: thin(gradient(image)), truths, 1.0),
    }
    cannies = [score(lambda image, by=by: canny(image, by), truths, 1.0, len(LEVELS)) for by in SMOOTHINGS]
    scores["canny"] = max(cannies, key=lambda found: found.ods)
    for method, found in scores.items():
        print(
            f"{method:10}  ODS {found.ods:.3f}  OIS {found.ois:.3f}  precision {found.precision:.3f}  "
            f"recall {found.recall:.3f}  at {found.threshold:.3f}",
            flush=True,
        )
    return scores


def score(detect: Callable[[np.ndarray], np.ndarray], truths: Truths, highest: float, steps: int = 15) -> ContourScores:
    """Score a detector of thin contours at `steps` thresholds up to `highest`."""
    thresholds = np.arange(1, steps + 1) / steps * highest
    return score_contours([count_matches(detect(image), marked, thresholds) for image, marked in truths], thresholds)


def whole(image: np.ndarray) -> np.ndarray:
    """Take all of an image as valid."""
    return np.ones(image.shape[:2], bool)


def gradient(image: np.ndarray) -> np.ndarray:
    """Measure contour strength as the stage does by default."""
    params = EdgesParams()
    return multiscale_gradient(
        image, whole(image), params.scales, params.full_strength_percentile, params.min_full_strength
    )


def canny(image: np.ndarray, smoothing: float) -> np.ndarray:
    """Give each pixel the share of Canny's upper thresholds at which it is a contour; the lower one is 0.4 of it."""
    grey = cv2.GaussianBlur(cv2.cvtColor(image, cv2.COLOR_RGB2GRAY), (0, 0), smoothing)
    strength = np.zeros(grey.shape)
    for index, level in enumerate(LEVELS):
        # A tie of rounding must not lose a level.
        strength[cv2.Canny(grey, 0.4 * level, level, L2gradient=True) > 0] = (index + 1) / len(LEVELS) + 1e-9
    return strength


def print_costs() -> None:
    """Print seconds of one core for an image of 640x480, and how often that is Canny's."""
    (picture,) = held_out_renders(1, 1, 640)
    forest = read_forest()
    grey = cv2.cvtColor(picture.image, cv2.COLOR_RGB2GRAY)
    seconds = {}
    for method, detect in {
        "structured": lambda: structured_contours(picture.image, whole(picture.image), forest),
        "gradient": lambda: gradient(picture.image),
        "canny": lambda: cv2.Canny(cv2.GaussianBlur(grey, (0, 0), 2.0), 40, 100, L2gradient=True),
    }.items():
        detect()  # compiles
        times = []
        for _ in range(5):
            start = time.process_time()
            detect()
            times.append(time.process_time() - start)
        seconds[method] = min(times)
        print(f"{method:10}  {seconds[method]:.4f} s of core for 640x480")
    print(f"the forest takes {seconds['structured'] / seconds['canny']:.0f} times as long as Canny's detector")


if __name__ == "__main__":
    run_command(main)
