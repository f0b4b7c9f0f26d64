"""Exact, property and rejection: the residual of cylinders with known faults."""

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation
from scipy.stats import norm

from threedfs.errors import UserError
from threedfs.evaluate.cylinder import fit_cylinder, measure_cylinder
from threedfs.types import Mesh

AXIS = np.array([1.0, 2.0, -0.5]) / np.linalg.norm([1.0, 2.0, -0.5])


def can(height=3.6, radius=1.0, sections=200, turned=True):
    made = trimesh.creation.cylinder(radius=radius, height=height, sections=sections)
    made = made.subdivide_to_size(0.25)
    vertices = np.asarray(made.vertices)
    if turned:
        rotation = Rotation.align_vectors([AXIS], [[0, 0, 1]])[0].as_matrix()
        vertices = vertices @ rotation.T + [4, -1, 2]
    return Mesh(vertices, np.asarray(made.faces))


def measure(mesh):
    return measure_cylinder(mesh, 4000, np.random.default_rng(0))


@pytest.mark.parametrize("height", [1.0, 2.0, 3.6])
def test_a_can_has_no_residual(height):
    found = measure(can(height))
    # 200 facets sag by 1 - cos(pi / 200) = 0.012 % of the radius
    assert found.percentile_90 < 2e-4
    assert found.cylinder.radius == pytest.approx(1, rel=2e-4)
    assert abs(found.cylinder.axis @ AXIS) == pytest.approx(1, abs=1e-6)


def test_scale_does_not_matter():
    mesh = can()
    waved = mesh.vertices * (1 + 0.02 * np.sin(5 * mesh.vertices[:, :1]))
    small, large = measure(Mesh(waved, mesh.faces)), measure(Mesh(50 * waved, mesh.faces))
    assert large.median == pytest.approx(small.median, rel=1e-3)


def test_a_sine_along_the_side_leaves_its_own_median():
    mesh = can(turned=False, height=4)
    x, y, z = mesh.vertices.T
    amplitude = 0.01
    side = np.hypot(x, y) > 0.99
    factor = np.where(side, 1 + amplitude * np.sin(8 * np.arctan2(y, x)), 1)
    found = measure(Mesh(np.column_stack([x * factor, y * factor, z]), mesh.faces))
    # |sin| has median sin(pi / 4) and 90th percentile sin(0.45 pi); facets flatten the wave a little
    assert found.median == pytest.approx(amplitude * np.sin(np.pi / 4), rel=0.05)
    assert found.percentile_90 == pytest.approx(amplitude * np.sin(0.45 * np.pi), rel=0.05)


def test_fit_to_noisy_points():
    generator = np.random.default_rng(1)
    angle, height = generator.uniform(0, 2 * np.pi, 20000), generator.uniform(-2, 2, 20000)
    radius = 1.5 + 0.01 * generator.normal(size=20000)
    points = np.column_stack([3 + radius * np.cos(angle), 1 + radius * np.sin(angle), height])
    found = fit_cylinder(points, np.array([0.1, -0.05, 1.0]))
    assert found.radius == pytest.approx(1.5, abs=5e-4)
    # the median of |normal noise| is 0.674 of its standard deviation, to 2 % with 20000 points
    assert np.median(np.abs(found.distance(points))) == pytest.approx(0.01 * norm.ppf(0.75), rel=0.03)


def test_a_dent_does_not_pull_the_fit():
    mesh = can(turned=False)
    dented = mesh.vertices.copy()
    dented[(dented[:, 0] > 0.9) & (np.abs(dented[:, 2]) < 0.6)] *= (0.7, 0.7, 1)
    found = measure(Mesh(dented, mesh.faces))
    assert found.cylinder.radius == pytest.approx(1, rel=5e-3)
    assert found.median < 5e-3


def test_refuses_what_has_no_side():
    flat = Mesh(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]]))
    with pytest.raises(UserError, match="expected the side of a can"):
        measure(flat)
