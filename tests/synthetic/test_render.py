"""Exact tests of depth, mask and pose convention; property tests of light, shadow and highlight."""

import numpy as np
import pytest
from ball import CAMERA, CENTRE, GREY, RADIUS, ball_scene, view_from
from scipy.ndimage import binary_dilation, binary_erosion

from threedfs.errors import UserError
from threedfs.geometry.projection import project
from threedfs.geometry.raycast import RayCaster
from threedfs.geometry.rigid import make_transform
from threedfs.synthetic.film import expose
from threedfs.synthetic.light import Light
from threedfs.synthetic.render import Renderer, pixel_rays
from threedfs.synthetic.shadow import CastLight
from threedfs.synthetic.solid import Material
from threedfs.types import View


@pytest.fixture(scope="module")
def ball():
    return Renderer(ball_scene(), shadow_rays=32, ambient_rays=16, shadow_spacing=0.01)


def analytic_ball_depth(view):
    """Depth of the ball along each pixel's ray, NaN where it misses, by solving the quadratic."""
    origins, directions = pixel_rays(view)
    start = origins - CENTRE
    a = (directions**2).sum(-1)
    b = (directions * start).sum(-1)
    root = b**2 - a * ((start**2).sum(-1) - RADIUS**2)
    with np.errstate(invalid="ignore"):
        return ((-b - np.sqrt(root)) / a).reshape(view.camera.shape)


def test_depth_of_the_ball_in_closed_form(ball):
    view = view_from((0.5, -0.3, 0.4))
    truth, depth, mask = analytic_ball_depth(view), ball.depth(view), ball.mask(view)
    inner = binary_erosion(mask, iterations=2)
    # The mesh lies below the sphere by at most edge**2 / (8 R) = 1.5e-5 (edge 0.0035 at five subdivisions),
    # seen at a slant of up to five times that two pixels inside the rim.
    np.testing.assert_allclose(depth[inner], truth[inner], atol=8e-5)


def test_depth_of_the_table_in_closed_form(ball):
    view = view_from((0.5, -0.3, 0.4))
    origins, directions = pixel_rays(view)
    plane = (-origins[:, 2] / directions[:, 2]).reshape(CAMERA.shape)
    point = (origins + plane.reshape(-1, 1) * directions).reshape(*CAMERA.shape, 3)
    table = ~ball.mask(view) & (plane > 0) & np.all(np.abs(point[..., :2]) < 0.79, axis=-1)
    assert table.sum() > 5000
    np.testing.assert_allclose(ball.depth(view)[table], plane[table], rtol=1e-12)


def test_mask_area_in_closed_form(ball):
    view = view_from((0.5, -0.3, 0.4))
    distance = np.linalg.norm(view.centre - CENTRE)
    area = np.pi * CAMERA.fx**2 * RADIUS**2 / (distance**2 - RADIUS**2)
    # A disc of radius 22 pixels: the count of centres in it is off by a few (Gauss circle), the facets by less.
    assert ball.mask(view).sum() == pytest.approx(area, abs=12)


@pytest.mark.parametrize("centre", [(0.5, -0.3, 0.4), (-0.45, 0.1, 0.5), (0.05, 0.6, 0.2)])
def test_projected_vertices_fill_the_mask(ball, centre):
    """Poses, intrinsics and masks agree: box and centroid of both to well below a pixel."""
    view = view_from(centre, target=np.array([0.05, 0.03, 0.06]))
    pixels, _ = project(view, ball.scene.solid.mesh.vertices)
    mask = ball.mask(view)
    v, u = np.nonzero(mask)
    low, high = pixels.min(axis=0), pixels.max(axis=0)
    # The outermost centres inside lie up to one pixel inside the outline; near a rounded tip a little more.
    for inner, outer in [((u.min(), v.min()), low), (-np.array((u.max(), v.max())), -high)]:
        assert np.all(inner >= outer) and np.all(inner <= outer + 1.3)
    rows, columns = np.rint(pixels[:, 1]).astype(int), np.rint(pixels[:, 0]).astype(int)
    assert np.all(binary_dilation(mask, np.ones((3, 3)))[rows, columns])  # outline vertices may round outward
    assert not np.all(binary_erosion(mask, iterations=1)[rows, columns])


@pytest.mark.parametrize("axis", [0, 1])
def test_image_agrees_with_the_pose_at_the_middle_of_the_exposure(axis):
    """Antialiasing and motion blur spread the object evenly around its mask, along both axes of the image."""
    ambient_only = Light((0.8, 0.0, 1.2), 0.1, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    roll = np.eye(3) if axis == 0 else np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]])
    level = make_transform(roll, np.zeros(3)) @ view_from((0.5, -0.3, 0.4)).cam_from_world
    speed = np.eye(3)[axis] * 0.4  # 4 pixels in the exposure

    def moving(time):
        return make_transform(np.eye(3), speed * time) @ level

    images = []
    for white in (0.0, 1.0):
        material = Material(lambda p, f, white=white: np.full((len(p), 3), white))
        renderer = Renderer(ball_scene(material, ambient_only), shadow_rays=4, ambient_rays=32, shadow_spacing=0.02)
        images.append(expose(renderer, CAMERA, moving, 0.0, 1 / 20, 8)[..., 0])
    # Ambient light varies with height only, so across the image's `axis` (horizontal in the world) it is even.
    weight = (images[1] - images[0]).sum(axis=axis)
    centroid = (weight * np.arange(len(weight))).sum() / weight.sum()
    mask = renderer.mask(View("", CAMERA, level)).sum(axis=axis)
    expected = (mask * np.arange(len(mask))).sum() / mask.sum()
    assert centroid == pytest.approx(expected, abs=0.1)


def light_on_table(renderer, x, y):
    """Red radiance at a point of the table, seen from straight above it."""
    view = view_from((x + 1e-6, y, 0.6), target=np.array([x, y, 0.0]))
    return renderer.radiance(view)[60, 80, 0]


def test_shadow_falls_away_from_the_lamp(ball):
    # The lamp stands at 45 degrees over +x; the ball's shadow ends near x = -0.25.
    lit, shaded = light_on_table(ball, 0.25, 0.0), light_on_table(ball, -0.12, 0.0)
    assert shaded < 0.4 * lit
    assert light_on_table(ball, -0.45, 0.0) == pytest.approx(
        light_on_table(ball, -0.45, 0.3), rel=0.3
    )  # beyond the shadow it is as bright as beside it, up to the lamp's distance


def test_larger_lamps_make_softer_shadows():
    def penumbra(radius):
        scene = ball_scene(light=Light((0.8, 0.0, 1.2), radius, (2.0, 2.0, 2.0), (0.0, 0.0, 0.0)))
        cast = CastLight(scene, RayCaster(scene.solid.mesh), shadow_rays=64, ambient_rays=1, spacing=0.006)
        line = np.column_stack([np.linspace(-0.4, -0.1, 301), np.zeros(301), np.zeros(301)])
        lamp, _ = cast.on_table(line)
        return np.mean((lamp > 0.1) & (lamp < 0.9))

    narrow, wide = penumbra(0.04), penumbra(0.16)
    assert narrow > 0
    assert 3 < wide / narrow < 5  # in proportion to the lamp


def test_contact_darkens_the_table():
    scene = ball_scene()
    cast = CastLight(scene, RayCaster(scene.solid.mesh), shadow_rays=4, ambient_rays=64, spacing=0.005)
    _, ambient = cast.on_table(np.array([[0.015, 0, 0], [0.1, 0, 0], [0.5, 0, 0]]))
    assert ambient[0] < ambient[1] < ambient[2]
    # Closed form for a ball of radius R at height R seen from distance r: 1 - R**3 / (r**2 + R**2)**1.5.
    assert ambient[1] == pytest.approx(1 - 1 / 2**1.5, abs=0.04)  # 64 rays, steps of 1/64 each


def test_a_camera_outside_the_room_is_refused(ball):
    with pytest.raises(UserError, match="inside the room"):
        ball.depth(view_from((3.0, 0.0, 0.5)))


def test_highlight_sits_where_the_mirror_direction_is():
    view = view_from((0.5, -0.4, 0.45))
    quick = {"shadow_rays": 8, "ambient_rays": 4, "shadow_spacing": 0.02}
    matt = Renderer(ball_scene(Material(GREY)), **quick).radiance(view)
    glossy = Renderer(ball_scene(Material(GREY, specular=0.5, shininess=200)), **quick).radiance(view)
    extra = (glossy - matt)[..., 0]
    assert extra.min() > -1e-12
    # On a ball the highlight lies where the normal halves the angle between lamp and eye: find it by iteration.
    lamp, point = np.array([0.8, 0.0, 1.2]), CENTRE.copy()
    for _ in range(50):
        directions = [(end - point) / np.linalg.norm(end - point) for end in (lamp, view.centre)]
        half = sum(directions) / np.linalg.norm(sum(directions))
        point = CENTRE + RADIUS * half
    expected, _ = project(view, point)
    row, column = np.unravel_index(extra.argmax(), extra.shape)
    assert np.hypot(column - expected[0], row - expected[1]) < 1.5  # vertices' normals are interpolated


def test_mirrors_show_the_room():
    view = view_from((0.5, -0.4, 0.25))
    quick = {"shadow_rays": 8, "ambient_rays": 4, "shadow_spacing": 0.02}
    black = Material(lambda p, f: np.zeros((len(p), 3)), 0.0, 200, mirror=0.8)
    renderer = Renderer(ball_scene(black), **quick)
    inner = binary_erosion(renderer.mask(view), iterations=3)
    seen = renderer.radiance(view)[inner]
    assert seen.std() > 0.01 and seen.mean() > 0.05


def test_motion_blurs_the_table_and_time_stands_still_without_it(ball):
    view = view_from((0.5, -0.3, 0.4))

    def pushed(speed):
        def pose(time):
            return make_transform(np.eye(3), np.array([speed * time, 0, 0])) @ view.cam_from_world

        return expose(ball, CAMERA, pose, 0.0, 1 / 30, 4)[..., 0]

    def sharpness(image):
        return np.abs(np.diff(image, axis=1)).max()

    assert sharpness(pushed(3.0)) < 0.8 * sharpness(pushed(0.0))
    assert np.array_equal(pushed(0.0), pushed(0.0))
