"""The baseline of the depth experiment: known depths, interpolated (Section 4.2)."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import LinearNDInterpolator, NearestNDInterpolator
from scipy.spatial import QhullError

from threedfs.errors import UserError


def interpolate_depth(pixels: np.ndarray, depths: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """Interpolate known depths over an image.

    Parameters
    ----------
    pixels : (N, 2) int
        (row, column) of the known depths.
    depths : (N,) float64
    shape : tuple of int
        (H, W)

    Returns
    -------
    (H, W) float64
        Linear in row and column within each triangle of the Delaunay triangulation, so exact where depth is linear in
        the image; outside the hull of the known pixels, the depth of the nearest one.

    Raises
    ------
    UserError
        If the pixels are fewer than three or lie on one line.

    Notes
    -----
    The paper says "bilinear interpolation of known depth values". Scattered values have no cells for a bilinear
    function: triangles with linear ones are the usual reading. Depth itself is interpolated, as the paper says;
    inverse depth would be exact on planes in space.
    """
    try:
        linear = LinearNDInterpolator(pixels, depths)
    except (QhullError, ValueError) as fault:
        raise UserError(
            f"depth interpolation: expected at least three known pixels that are not on one line, got {len(pixels)}; "
            "draw more measurements, or give true depth images with more depths."
        ) from fault
    everywhere = np.indices(shape).reshape(2, -1).T
    depth = linear(everywhere)
    outside = np.isnan(depth)
    if outside.any():
        depth[outside] = NearestNDInterpolator(pixels, depths)(everywhere[outside])
    return depth.reshape(shape)
