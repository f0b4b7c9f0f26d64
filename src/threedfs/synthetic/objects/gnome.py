"""A garden gnome, 0.21 high: knitted coat, glossy hat, woolly beard, brass lantern."""

from __future__ import annotations

import numpy as np

from threedfs.synthetic.fields import (
    Field,
    box,
    cylinder,
    displace,
    ellipsoid,
    intersection,
    mirror_x,
    offset,
    round_cone,
    smooth_union,
    sphere,
    torus,
    union,
)
from threedfs.synthetic.noise import fractal_noise
from threedfs.synthetic.solid import Material, Part, Solid, build_solid
from threedfs.synthetic.textures import knitted, plain, speckled, streaked


def make_gnome(spacing: float = 0.0024, seed: int = 7) -> Solid:
    """Make the gnome: it stands on z = 0 around the origin and faces -y.

    Parameters
    ----------
    spacing : float
        Edge of a marching cubes cell; sets how fine the mesh is.
    seed : int
        Seed of its textures.
    """
    coat = Material(knitted((0.03, 0.10, 0.30), (0.55, 0.55, 0.42), 0.0032, seed))
    hat = Material(speckled((0.60, 0.03, 0.035), (0.38, 0.015, 0.02), 0.0022, 0.4, seed + 1), 0.15, 25)
    skin = Material(plain((0.70, 0.38, 0.27), 0.08, 0.012, seed + 2), 0.05, 20)
    beard = Material(streaked((0.80, 0.77, 0.70), (0.34, 0.31, 0.27), 0.0016, 0.014, seed + 3))
    wool = Material(speckled((0.78, 0.75, 0.68), (0.45, 0.41, 0.35), 0.002, 0.35, seed + 4))
    leather = Material(speckled((0.075, 0.035, 0.018), (0.14, 0.07, 0.035), 0.004, 0.4, seed + 5), 0.12, 40, 0.02)
    brass = Material(plain((0.36, 0.22, 0.05), 0.10, 0.01, seed + 6), 0.5, 90, 0.25)
    glass = Material(plain((0.85, 0.60, 0.18), 0.15, 0.006, seed + 7), 0.3, 120, 0.04)
    ink = Material(plain((0.015, 0.012, 0.012)), 0.3, 150, 0.03)
    parts = [
        Part(_coat(), coat),
        Part(_belt(), leather),
        Part(_buckle(), brass),
        Part(_boots(), leather),
        Part(_sleeves(), coat),
        Part(_cuffs(), wool),
        Part(_hands(), skin),
        Part(_head(), skin),
        Part(_eyes(), ink),
        Part(_beard(seed), beard),
        Part(_hat(), hat),
        Part(_brim(seed), wool),
        Part(_pompom(seed), wool),
        Part(_lantern_metal(), brass),
        Part(_lantern_glass(), glass),
    ]
    return build_solid(parts, (-0.085, -0.085, 0.0), (0.085, 0.06, 0.23), spacing)


def _coat() -> Field:
    trunk = round_cone((0, 0, 0.036), (0, 0, 0.098), 0.043, 0.027)
    hem = torus((0, 0, 0.014), (0, 0, 1), 0.036, 0.010)
    return smooth_union(0.012, trunk, hem)


def _belt() -> Field:
    band = box((0, 0, 0.050), (0.1, 0.1, 0.0065), 0.001)
    return intersection(offset(round_cone((0, 0, 0.036), (0, 0, 0.098), 0.043, 0.027), 0.0028), band)


def _buckle() -> Field:
    frame = box((0, -0.0435, 0.050), (0.012, 0.004, 0.0095), 0.002)
    pin = cylinder((0, -0.047, 0.050), (0, -0.0495, 0.050), 0.004, 0.001)
    return union(frame, pin)


def _boots() -> Field:
    toe = ellipsoid((0.0215, -0.030, 0.010), (0.0165, 0.026, 0.0145))
    sole = box((0.0215, -0.026, 0.003), (0.016, 0.030, 0.004), 0.003)
    return mirror_x(smooth_union(0.006, toe, sole))


def _sleeves() -> Field:
    left = smooth_union(
        0.008,
        round_cone((-0.027, 0, 0.092), (-0.052, -0.004, 0.070), 0.0135, 0.0125),
        round_cone((-0.052, -0.004, 0.070), (-0.040, -0.032, 0.058), 0.0125, 0.0115),
    )
    right = smooth_union(
        0.008,
        round_cone((0.027, 0, 0.092), (0.053, -0.010, 0.078), 0.0135, 0.0125),
        round_cone((0.053, -0.010, 0.078), (0.054, -0.036, 0.084), 0.0125, 0.0115),
    )
    return union(left, right)


def _cuffs() -> Field:
    return union(
        torus((-0.039, -0.034, 0.0575), (0.38, -0.88, -0.36), 0.0098, 0.0042),
        torus((0.054, -0.038, 0.0845), (0.03, -0.97, 0.22), 0.0098, 0.0042),
    )


def _hands() -> Field:
    resting = union(
        sphere((-0.034, -0.043, 0.053), 0.0100),
        round_cone((-0.031, -0.046, 0.058), (-0.024, -0.047, 0.058), 0.0045, 0.0035),
    )
    holding = union(
        sphere((0.0545, -0.049, 0.086), 0.0105),
        round_cone((0.050, -0.053, 0.094), (0.047, -0.056, 0.097), 0.0042, 0.0036),
    )
    return union(resting, holding)


def _head() -> Field:
    nose = sphere((0, -0.037, 0.1165), 0.0092)
    ears = mirror_x(ellipsoid((0.0285, -0.002, 0.116), (0.006, 0.0045, 0.009)))
    cheeks = mirror_x(sphere((0.013, -0.025, 0.113), 0.0085))
    return smooth_union(0.003, sphere((0, -0.003, 0.115), 0.0285), nose, ears, cheeks)


def _eyes() -> Field:
    return mirror_x(sphere((0.0095, -0.0292, 0.1245), 0.0030))


def _beard(seed: int) -> Field:
    def strands(points: np.ndarray) -> np.ndarray:
        return 0.0016 * fractal_noise(points / (0.004, 0.004, 0.022), 0.0, 1.0, 2, 0.5, seed + 11)

    chin = smooth_union(
        0.010,
        round_cone((0, -0.021, 0.100), (0, -0.040, 0.066), 0.0200, 0.0070),
        mirror_x(round_cone((0.012, -0.014, 0.106), (0.021, -0.008, 0.113), 0.0125, 0.0075)),
    )
    moustache = mirror_x(round_cone((0.003, -0.0385, 0.1080), (0.0175, -0.036, 0.1030), 0.0062, 0.0034))
    return displace(union(chin, moustache), strands)


def _hat() -> Field:
    return smooth_union(
        0.006,
        round_cone((0, -0.001, 0.131), (0.001, 0.002, 0.162), 0.0285, 0.0180),
        round_cone((0.001, 0.002, 0.162), (0.007, 0.009, 0.187), 0.0180, 0.0105),
        round_cone((0.007, 0.009, 0.187), (0.020, 0.017, 0.202), 0.0105, 0.0060),
    )


def _woolly(seed: int, height: float, size: float) -> Field:
    return lambda points: height * fractal_noise(points, 0.0, size, 2, 0.5, seed)


def _brim(seed: int) -> Field:
    return displace(torus((0, -0.001, 0.1335), (0, 0, 1), 0.0270, 0.0062), _woolly(seed + 12, 0.0010, 0.004))


def _pompom(seed: int) -> Field:
    return displace(sphere((0.026, 0.020, 0.203), 0.0105), _woolly(seed + 13, 0.0018, 0.004))


def _lantern_metal() -> Field:
    x, y = 0.056, -0.056
    foot = cylinder((x, y, 0.040), (x, y, 0.0455), 0.0115, 0.0015)
    roof = round_cone((x, y, 0.0700), (x, y, 0.0785), 0.0100, 0.0035)
    ring = torus((x, y, 0.0835), (1, 0, 0), 0.0050, 0.0022)
    posts = [
        cylinder((x + dx, y + dy, 0.043), (x + dx, y + dy, 0.071), 0.0021)
        for dx in (-0.0078, 0.0078)
        for dy in (-0.0078, 0.0078)
    ]
    return union(foot, roof, ring, *posts)


def _lantern_glass() -> Field:
    return cylinder((0.056, -0.056, 0.044), (0.056, -0.056, 0.069), 0.0083, 0.001)
