"""Train the forest of the contour detector (`make contours`): the same seed gives the same bytes.

    python benchmarks/train_contours.py [--seed 23] [--leaves 150 --still-lifes 100 --windows 200 --trees 4]
        [--output FILE]

Nothing is read: pictures are painted and rendered. Without --output the forest of the package is replaced, and its
checksum in its reader's source.
"""

from __future__ import annotations

import argparse
import re
import sys
import time
from collections.abc import Iterable
from pathlib import Path

import cv2

from threedfs.edges.training.train import Plan, make_pictures, train_forest
from threedfs.io import contour_forest


def main() -> None:
    """Train and write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    default = Plan()
    for name in ("seed", "tiles", "leaves", "still_lifes", "windows", "trees"):
        parser.add_argument("--" + name.replace("_", "-"), type=int, default=getattr(default, name))
    parser.add_argument("--output", type=Path)
    options = vars(parser.parse_args())
    output = options.pop("output")
    cv2.setNumThreads(1)
    plan = Plan(**options)
    forest = train_forest(plan, make_pictures(plan, track), track)
    digest = contour_forest.write_forest(output or contour_forest.CARRIED, forest)
    if output is None:
        source = Path(contour_forest.__file__)
        text = re.sub(r"^SHA256 = .*$", f'SHA256 = "{digest}"', source.read_text(), flags=re.MULTILINE)
        source.write_text(text)
    size = (output or contour_forest.CARRIED).stat().st_size
    print(f"{len(forest.feature)} nodes, {len(forest.labels)} leaves, {size / 1e6:.2f} MB, SHA-256 {digest}")


def track(items: Iterable, what: str) -> Iterable:
    """Tell progress on the error stream, one line a step of a tenth."""
    items, start = list(items), time.monotonic()
    for index, item in enumerate(items):
        if index % max(len(items) // 10, 1) == 0:
            print(f"{what} {index + 1} of {len(items)}, {time.monotonic() - start:.0f} s", file=sys.stderr, flush=True)
        yield item


if __name__ == "__main__":
    main()
