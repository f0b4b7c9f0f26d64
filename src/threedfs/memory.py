"""Memory that stages on a voxel grid need, for the scheduler."""

from __future__ import annotations

_PROGRAM = 400
"""MB of Python, its libraries, and the maps of one keyframe."""

_BYTES_PER_VOXEL = {
    "fuse_scene": 40,
    "locate": 30,
    "fuse_object": 40,
    "fuse_baseline": 40,
    "deform": 40,
    "locate_object": 30,
    "object": 60,
    "cut_object": 150,
    "surface": 150,
    "segment": 140,
    "volumetric_cut": 120,
}
"""At most, over a cube: the highest peaks of the benchmark's jobs are 0.37 to 0.78 of what these give."""

_BYTES_PER_PIXEL = {"segment": 80, "surface": 12, "volumetric_cut": 20}
"""Of every keyframe, which these stages hold all at once; surface holds masks of three times as many frames."""


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
