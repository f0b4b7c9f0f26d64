"""What rules tell the scheduler of their memory, against what the benchmark's jobs took."""

import pytest

from threedfs.memory import (
    estimate_memory,
    estimate_memory_of_keyframes,
    estimate_memory_of_matting,
    grow_memory,
)

TABLETOP, BLOWTORCH = {"pixels": 640 * 480, "keyframes": 20}, {"pixels": 640 * 480, "keyframes": 67}


@pytest.mark.parametrize(
    ("stage", "side", "held", "peak"),
    [
        ("fuse_scene", 200, {}, 402),
        ("fuse_object", 200, {}, 382),
        ("locate", 200, {}, 291),
        ("locate_object", 200, {}, 304),
        ("deform", 200, {"unknowns": 4000}, 404),
        ("object", 200, {}, 459),
        ("cut_object", 200, {}, 1155),
        ("segment", 200, BLOWTORCH, 2021),
        ("volumetric_cut", 100, BLOWTORCH, 1231),
        ("volumetric_cut", 100, TABLETOP, 706),
        ("volumetric_cut", 200, TABLETOP, 1828),
    ],
)
def test_estimate_holds_the_peak_of_the_benchmark_and_not_thrice_as_much(stage, side, held, peak):
    """Regression: the highest peaks of all sequences, MB, on grids of so many voxels along the longest side."""
    assert peak < estimate_memory(stage, side, **held) < 3 * peak


def test_estimate_grows_with_the_grid_and_with_the_keyframes_that_are_held():
    """Exact."""
    small, large = (estimate_memory("cut_object", side) for side in (200, 400))
    assert large - 400 == 8 * (small - 400)
    assert estimate_memory("fuse_object", 200, **BLOWTORCH) == estimate_memory("fuse_object", 200)
    assert estimate_memory("segment", 200, **BLOWTORCH) > estimate_memory("segment", 200, **TABLETOP)


@pytest.mark.parametrize(("rule", "candidates", "peak"), [("depth", 64, 686), ("cues", 0, 332), ("stereo", 0, 260)])
def test_estimate_holds_the_peak_of_a_keyframe_and_grows_with_those_at_work(rule, candidates, peak):
    """Regression: the highest peaks at 640 x 480 pixels, MB."""
    one, two, three = (estimate_memory_of_keyframes(rule, 640 * 480, at_once, candidates) for at_once in (1, 2, 3))
    assert peak < one < 4 * peak
    assert abs(three - two - (two - one)) <= 1


@pytest.mark.parametrize(("keyframes", "peak"), [(24, 530), (36, 618)])
def test_estimate_of_matting_holds_the_peak_and_grows_with_the_pixels_at_work(keyframes, peak):
    """Regression: the peaks of the sample and of tum_bunny, MB."""
    held = estimate_memory("spectral_matting", 200, pixels=400_000, keyframes=keyframes)
    assert peak < held + estimate_memory_of_matting(60_000, 50) < 3 * peak
    assert estimate_memory_of_matting(120_000, 50) == 2 * estimate_memory_of_matting(60_000, 50)
    assert estimate_memory_of_matting(60_000, 100) > estimate_memory_of_matting(60_000, 50)


def test_every_attempt_asks_for_twice_the_memory():
    """Exact."""
    first, second, third = (grow_memory(1000, attempt) for attempt in (1, 2, 3))
    assert first > 1000 and (second, third) == (2 * first, 4 * first)


def test_estimate_grows_with_the_depths_that_are_tried():
    """Regression: the peaks of a keyframe of beer.mp4 with 64 and 256 candidates, MB."""
    few, many = (estimate_memory_of_keyframes("depth", 529 * 842, 1, candidates) for candidates in (64, 256))
    assert 586 < few and 932 < many < 4 * 932
    assert 932 - 586 < many - few < 2 * (932 - 586)
