"""Cost of patch-match stereo: core seconds for one keyframe, by the number of views.

    python benchmarks/stereo.py [--height 480 --width 640] [--views 5]

The scene is that of the depth benchmark. Prints seconds of one core, the share of patches that match, and the peak
memory.
"""

from __future__ import annotations

import argparse
import resource
import time

import numpy as np
from scene import make_scene

from threedfs.params.stereo import StereoParams
from threedfs.stereo.patch_match import PatchRule, match_patches

RULE = ("radius", "stride", "likeness", "variance_floor", "least_variance", "best_views")


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--height", type=int, default=480)
    parser.add_argument("--width", type=int, default=640)
    parser.add_argument("--views", type=int, default=5)
    options = parser.parse_args()
    params = StereoParams()
    for height, width in ((48, 64), (options.height, options.width)):  # the small one compiles
        views, images = make_scene(height, width)
        start = time.process_time()
        found = match_patches(
            views[0],
            images[views[0].name],
            views[1 : 1 + options.views],
            [images[view.name] for view in views[1 : 1 + options.views]],
            np.full((height, width), np.nan),
            np.ones((height, width), bool),
            near=0.6,
            far=1.8,
            rule=PatchRule(**{name: getattr(params, name) for name in RULE}),
            levels=params.levels,
            rounds=params.rounds,
            seed=0,
        )
        seconds = time.process_time() - start
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    matched = 100 * (found.cost < 0.15).mean()
    print(f"{options.width}x{options.height}, {options.views} views: {seconds:.1f} s of core, {matched:.0f} % match")
    print(f"peak {peak:.0f} MB")


if __name__ == "__main__":
    main()
