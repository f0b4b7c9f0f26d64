"""Exact and property: data on half of the pixels along each axis, and the surface taken back."""

import numpy as np

from threedfs.depth.halving import DepthData, double_depth, halve_data


def make_data(shape, seed=0):
    rng = np.random.default_rng(seed)
    weight = np.where(rng.random(shape) < 0.3, rng.random(shape), 0.0)
    measured = np.where(weight > 0, 1 + rng.random(shape), np.nan)
    volume = rng.random((5, *shape)).astype(np.float32)
    return DepthData(volume, rng.random(shape), measured, weight, rng.random(shape))


def blocks(image):
    """The four pixels of each block (..., h, w, 4), the last row and column repeated where they are odd."""
    rows, columns = image.shape[-2:]
    image = np.concatenate([image, image[..., -1:, :]], axis=-2) if rows % 2 else image
    image = np.concatenate([image, image[..., -1:]], axis=-1) if columns % 2 else image
    return np.stack([image[..., a::2, b::2] for a in (0, 1) for b in (0, 1)], axis=-1)


def test_every_array_is_put_together():
    for shape in ((6, 8), (7, 9)):
        data = make_data(shape)
        half = halve_data(data)
        assert np.allclose(half.cost_volume, blocks(data.cost_volume).mean(-1), atol=1e-6)
        assert np.allclose(half.confidence, blocks(data.confidence).mean(-1))
        assert np.allclose(half.edge_weight, blocks(data.edge_weight).min(-1))
        weight, measured = blocks(data.measurement_weight), np.nan_to_num(blocks(data.measured_depth))
        assert np.allclose(half.measurement_weight, weight.mean(-1))
        known = weight.sum(-1) > 0
        assert np.array_equal(np.isfinite(half.measured_depth), known)
        expected = (weight * measured).sum(-1)[known] / weight.sum(-1)[known]
        assert np.allclose(half.measured_depth[known], expected)


def test_a_plane_comes_back():
    """A block lies between its pixels: the plane through block means is the plane, but for the repeated border."""
    v, u = np.mgrid[:31, :40]
    plane = 2 + 0.01 * u - 0.02 * v
    doubled = double_depth(blocks(plane).mean(-1), plane.shape)
    assert doubled.shape == plane.shape and doubled.dtype == np.float64
    assert np.abs(doubled - plane)[1:-3, 1:-1].max() < 1e-6
