"""Property and convergence tests of the meshes of objects."""

import numpy as np
import pytest
import trimesh

from threedfs.errors import UserError
from threedfs.synthetic.fields import box, half_space, intersection, sphere, subtract
from threedfs.synthetic.objects.gnome import make_gnome
from threedfs.synthetic.solid import Material, Part, build_solid
from threedfs.synthetic.textures import plain

GREY = Material(plain((0.5, 0.5, 0.5)))


def surface_of(solid):
    return trimesh.Trimesh(solid.mesh.vertices, solid.mesh.faces, process=False)


def test_gnome_is_one_closed_surface_that_stands_on_the_table():
    gnome = make_gnome(spacing=0.004)
    surface = surface_of(gnome)
    assert surface.is_watertight and surface.is_winding_consistent
    assert surface.body_count == 1
    assert surface.volume > 0
    assert surface.bounds[0, 2] == pytest.approx(0, abs=1e-6)
    flat = np.abs(surface.triangles_center[:, 2]) < 1e-6
    assert surface.area_faces[flat].sum() > 0.003  # it stands on its coat and boots, not on a point
    assert set(np.unique(gnome.material_of(gnome.mesh.vertices))) == set(range(len(gnome.materials)))


def test_normals_point_outward():
    solid = build_solid([Part(sphere((0, 0, 0.6), 0.5), GREY)], (-0.5, -0.5, 0), (0.5, 0.5, 1.1), 0.05)
    outward = solid.mesh.vertices - [0, 0, 0.6]
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    assert np.min((outward * solid.normals).sum(-1)) > 1 - 1e-6  # central differences of an exact distance


def test_volume_converges_to_the_ball():
    volume = 4 / 3 * np.pi * 0.5**3
    part = Part(sphere((0, 0, 0.6), 0.5), GREY)
    error = [
        abs(surface_of(build_solid([part], (-0.5, -0.5, 0), (0.5, 0.5, 1.1), h)).volume / volume - 1)
        for h in (0.1, 0.05)
    ]
    assert error[1] < 0.01
    assert error[1] < 0.35 * error[0]  # second order: a quarter


def test_what_lies_below_the_table_is_cut_off():
    solid = build_solid([Part(sphere((0, 0, 0), 0.5), GREY)], (-0.5, -0.5, 0), (0.5, 0.5, 0.5), 0.05)
    assert solid.mesh.vertices[:, 2].min() == pytest.approx(0, abs=1e-6)
    assert surface_of(solid).volume == pytest.approx(2 / 3 * np.pi * 0.5**3, rel=0.02)


def test_hidden_hollows_are_filled():
    shell = subtract(sphere((0, 0, 0.6), 0.5), sphere((0, 0, 0.6), 0.3))
    solid = build_solid([Part(shell, GREY)], (-0.5, -0.5, 0), (0.5, 0.5, 1.1), 0.05)
    assert surface_of(solid).volume == pytest.approx(4 / 3 * np.pi * 0.5**3, rel=0.02)


@pytest.mark.parametrize("normal", [(1, 0.05, 0.1), (0.97, -0.2, 0.13), (0.1, 0.13, 1), (0.2, 1, 0.15)])
def test_a_surface_that_just_misses_a_lattice_point_is_closed(normal):
    # The cells around that point give slivers a few nanometres high.
    for gap in (1e-9, 2e-9, 4e-9):
        point = np.array([0.01, 0.01, 0.03]) + gap * np.array(normal)
        cut = intersection(half_space(point, normal), box((0, 0, 0.03), (0.035, 0.035, 0.025)))
        solid = build_solid([Part(cut, GREY)], (-0.04, -0.04, 0), (0.04, 0.04, 0.06), 0.01)
        assert surface_of(solid).is_watertight


def test_loose_parts_are_refused():
    parts = [Part(sphere((x, 0, 0.2), 0.2), GREY) for x in (-0.5, 0.5)]
    with pytest.raises(UserError, match="hang together, got 2 pieces"):
        build_solid(parts, (-0.7, -0.2, 0), (0.7, 0.2, 0.4), 0.05)


def test_parts_outside_the_box_are_refused():
    with pytest.raises(UserError, match="enlarge the box"):
        build_solid([Part(box((0, 0, 0), (2, 0.1, 0.1)), GREY)], (-1, -1, 0), (1, 1, 1), 0.1)
