"""What rules tell the scheduler of their memory, against what the benchmark's jobs took."""

import pytest

from threedfs.memory import estimate_memory

TABLETOP, BLOWTORCH = {"pixels": 640 * 480, "keyframes": 20}, {"pixels": 640 * 480, "keyframes": 67}


@pytest.mark.parametrize(
    ("stage", "held", "peak"),
    [
        ("fuse_scene", {}, 402),
        ("fuse_object", {}, 382),
        ("locate", {}, 291),
        ("locate_object", {}, 304),
        ("deform", {"unknowns": 4000}, 404),
        ("object", {}, 459),
        ("cut_object", {}, 1155),
        ("segment", BLOWTORCH, 2021),
        ("volumetric_cut", BLOWTORCH, 1231),
    ],
)
def test_estimate_holds_the_peak_of_the_benchmark_and_not_thrice_as_much(stage, held, peak):
    """Regression: the highest peaks of all sequences, MB, measured on grids of 200 voxels along the longest side."""
    assert peak < estimate_memory(stage, 200, **held) < 3 * peak


def test_estimate_grows_with_the_grid_and_with_the_keyframes_that_are_held():
    """Exact."""
    small, large = (estimate_memory("cut_object", side) for side in (200, 400))
    assert large - 400 == 8 * (small - 400)
    assert estimate_memory("fuse_object", 200, **BLOWTORCH) == estimate_memory("fuse_object", 200)
    assert estimate_memory("segment", 200, **BLOWTORCH) > estimate_memory("segment", 200, **TABLETOP)
