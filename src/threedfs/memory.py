"""Memory that jobs need, for the scheduler."""

from __future__ import annotations

_PROGRAM = 400
"""MB of Python, its libraries, and the maps of one keyframe."""

_STARTERS = 250
"""MB of the two Snakemakes around a job on a cluster, which count as the job's."""

_WORKER = 150
"""MB of a process forked for a keyframe: most of it is its parent's too, and some clusters count it again."""

_BYTES_PER_VOXEL = {
    "fuse_scene": 40,
    "locate": 30,
    "fuse_object": 40,
    "fuse_baseline": 40,
    "deform": 40,
    "consistency": 0,
    "locate_object": 30,
    "object": 60,
    "cut_object": 150,
    "surface": 110,
    "segment": 140,
    "spectral_matting": 30,
    "volumetric_cut": 240,
}
"""At most, over a cube: the highest peaks of the benchmark's jobs are 0.37 to 0.78 of what these give."""

_BYTES_PER_PIXEL = {"segment": 80, "spectral_matting": 5, "surface": 20, "volumetric_cut": 50, "consistency": 40}
"""Of every keyframe, which these stages hold all at once; surface holds masks of three times as many frames."""

_BYTES_PER_PIXEL_AT_WORK = {
    "scout": 900,
    "cues": 900,
    "stereo": 900,
    "stereo_check": 900,
    "depth": 1880,
    "depth_trial": 1880,
}
"""Of each keyframe that a job works on; the highest peaks of the benchmark are 0.4 to 0.8 of what these give."""

_BYTES_PER_CANDIDATE = 5
"""Of each pixel where depth is searched: its cost, and its share in the cost of 2x2 pixels put together."""

_BYTES_PER_MATTED_PIXEL = 5000
"""Of the factors of the matting Laplacian, which fill in a little faster than an image grows."""


def estimate_memory(stage: str, longest_side: int, pixels: float = 0, keyframes: int = 0, unknowns: int = 0) -> int:
    """Estimate the memory of a stage on a voxel grid, MB.

    Parameters
    ----------
    stage : str
    longest_side : int
        Of the grid, voxels; it is taken for a cube.
    pixels : float
        Of an image.
    keyframes : int
    unknowns : int
        Of a fit, whose normal equations `deform` holds up to three times.

    Examples
    --------
    >>> estimate_memory("fuse_object", 200)
    720
    >>> estimate_memory("segment", 200, pixels=640 * 480, keyframes=20)
    2011
    """
    voxels = _BYTES_PER_VOXEL[stage] * longest_side**3
    fit = 3 * 8 * unknowns**2
    return int(_PROGRAM + (voxels + _BYTES_PER_PIXEL.get(stage, 0) * pixels * keyframes + fit) / 1e6)


def estimate_memory_of_keyframes(rule: str, pixels: float, at_once: int, candidates: int = 0) -> int:
    """Estimate the memory of a job that works on several keyframes at once, MB.

    Parameters
    ----------
    rule : str
    pixels : float
        Of a keyframe.
    at_once : int
    candidates : int
        Depths that are tried for each pixel, where any are.

    Examples
    --------
    >>> estimate_memory_of_keyframes("depth", 640 * 480, 1, candidates=64)
    1225
    """
    bytes_per_pixel = _BYTES_PER_PIXEL_AT_WORK[rule] + _BYTES_PER_CANDIDATE * candidates
    each = _WORKER + bytes_per_pixel * pixels / 1e6
    return int(_PROGRAM + at_once * each)


def estimate_memory_of_matting(pixels: int, eigenvectors: int) -> int:
    """Estimate the memory that spectral matting of one image adds to its program, MB.

    Parameters
    ----------
    pixels, eigenvectors : int

    Examples
    --------
    >>> estimate_memory_of_matting(60_000, 50)
    480
    """
    return int((_BYTES_PER_MATTED_PIXEL + 60 * eigenvectors) * pixels / 1e6)


def grow_memory(needed: float, attempt: int) -> int:
    """Return what to ask a scheduler for, MB: twice as much at every further attempt.

    Parameters
    ----------
    needed : float
        What the job itself needs.
    attempt : int
        From 1.

    Examples
    --------
    >>> grow_memory(1000, 1), grow_memory(1000, 2)
    (1250, 2500)
    """
    return int(_STARTERS + needed) * 2 ** (attempt - 1)
