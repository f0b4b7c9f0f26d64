"""Exact, property and rejection: the parts of a page, on made-up results."""

from __future__ import annotations

import base64
import html
import re
from dataclasses import replace

import cv2
import numpy as np
import pytest
import trimesh

from threedfs.report.camera_path import draw_path, unfilmed_angle
from threedfs.report.findings import Facts, judge, sum_up
from threedfs.report.index_page import Row, write_index
from threedfs.report.page import KeyframePictures, Report, write_page
from threedfs.report.pictures import color_depth, color_normals, embed_image, outline_mask
from threedfs.report.viewer import embed_viewer
from threedfs.texture.textured import TexturedMesh
from threedfs.types import Box, Camera, Keyframe, Mesh, Plane, Support, View

CAMERA = Camera(40, 30, 50.0, 50.0, 19.5, 14.5)
PLACE = Support(Plane(np.array([0.0, 0.0, 1.0]), 0.0), Box(np.eye(3), -np.ones(3), np.ones(3)), {})
GOOD = Facts(
    posed=100,
    frames=100,
    quality={"triangulation_angle": 20.0, "reprojection_error": 0.3, "step_ratio": 2.0},
    widest_gap=20.0,
    margin_used=0.3,
    closed=True,
    pieces=1,
    genus=0,
    confirmed=0.9,
)
HOSTILE = "<script>alert('\"1\"')</script>"


def ring(angles):
    """Cameras around the origin at angles, degrees, named by their number."""
    views = []
    for number, angle in enumerate(np.radians(angles)):
        centre = np.array([3 * np.cos(angle), 3 * np.sin(angle), 1.0])
        pose = np.eye(4)
        pose[:3, 3] = -centre
        views.append(View(f"{number:06d}", CAMERA, pose))
    return views


def ball():
    made = trimesh.creation.icosphere(subdivisions=2, radius=0.5)
    return Mesh(made.vertices + np.array([0, 0, 0.5]), np.asarray(made.faces))


def test_a_good_reconstruction_passes_all_checks():
    found = judge(GOOD)
    assert all(finding.good for finding in found)
    assert sum_up(found) == "All checks passed."


@pytest.mark.parametrize(
    ("change", "what"),
    [
        ({"posed": 80}, "frames placed"),
        ({"widest_gap": 120.0}, "widest side without a view"),
        ({"quality": {"triangulation_angle": 2.0}}, "angle between rays"),
        ({"quality": {"reprojection_error": 1.7}}, "error of the cameras"),
        ({"quality": {"step_ratio": 9.0}}, "largest step"),
        ({"margin_used": 1.2}, "room around the object"),
        ({"closed": False}, "mesh"),
        ({"pieces": 3}, "mesh"),
        ({"genus": 40}, "handles"),
        ({"confirmed": 0.2}, "surface that photographs agree on"),
    ],
)
def test_each_fault_is_the_first_finding_and_has_advice(change, what):
    found = judge(replace(GOOD, **change))
    assert [finding.good for finding in found].count(False) == 1
    assert found[0].what.startswith(what) and found[0].advice.endswith(".")
    assert found[0].what in sum_up(found)


def test_what_is_not_known_is_not_judged():
    found = judge(replace(GOOD, quality={}, margin_used=None, confirmed=None))
    assert len(found) == 4


@pytest.mark.parametrize(("angles", "gap"), [(range(0, 360, 10), 10), ([0, 90, 180], 180), ([10], 360)])
def test_the_widest_gap_around_the_object(angles, gap):
    assert unfilmed_angle(ring(angles), PLACE) == pytest.approx(gap)


def test_the_path_shows_every_camera_and_tells_keyframes_apart():
    drawn = draw_path(ring(range(0, 360, 30)), {"000000", "000003"}, PLACE)
    assert drawn.count("<circle") == 12 and drawn.count('r="4"') == 2
    spots = np.array([[float(x), float(y)] for x, y in re.findall(r'cx="([\d.]+)" cy="([\d.]+)"', drawn)])
    assert (spots > 0).all() and (spots < 420).all()
    around = spots - spots.mean(axis=0)
    radius = np.linalg.norm(around, axis=1)
    np.testing.assert_allclose(radius, radius.mean(), rtol=0.01)


def test_pictures_have_the_colours_that_they_promise():
    mask = np.zeros((30, 40), bool)
    mask[10:20, 10:20] = True
    image = np.zeros((30, 40, 3), np.uint8)
    drawn = outline_mask(image, mask)
    assert not image.any()  # the page shows the photograph as it is beside it
    assert (drawn[10, 10:20] == (0, 255, 0)).all() and not drawn[15, 15].any()
    keyframe = Keyframe(ring([0])[0], (), 1.0, 4.0)
    near, far = (color_depth(np.full((2, 2), depth), keyframe)[0, 0] for depth in (1.05, 3.9))
    assert near[0] > near[2] and far[2] >= far[0]
    facing = color_normals(np.broadcast_to([0.0, 0.0, -1.0], (2, 2, 3)))
    assert facing[0, 0].tolist() == [127, 127, 255]


def test_an_image_in_the_page_is_the_image():
    image = np.full((60, 90, 3), (200, 40, 90), np.uint8)
    head, _, data = embed_image(image, 45).partition(",")
    read = cv2.imdecode(np.frombuffer(base64.b64decode(data), np.uint8), cv2.IMREAD_COLOR)[..., ::-1]
    assert head == "data:image/jpeg;base64" and read.shape == (30, 45, 3)
    assert np.abs(read.astype(int) - (200, 40, 90)).max() < 6


@pytest.mark.parametrize("keyframes", [24, 200])
def test_the_pictures_of_many_keyframes_fit_into_the_page(keyframes):
    """Property: noise, which compresses worst, in four pictures a keyframe; few keyframes keep theirs whole."""
    image = np.random.default_rng(0).integers(0, 256, (420, 560, 3), dtype=np.uint8)
    smooth = cv2.GaussianBlur(image, (0, 0), 8)
    most = 5_000_000 / (4 * keyframes)
    noisy = embed_image(image, 420, 75, most)
    assert len(noisy) <= most
    data = base64.b64decode(embed_image(smooth, 420, 75, most).partition(",")[2])
    _, width = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR).shape[:2]
    assert width == 420 if keyframes == 24 else 80 <= width <= 420


def test_no_picture_becomes_smaller_than_can_be_seen():
    data = base64.b64decode(embed_image(np.zeros((60, 90, 3), np.uint8), 90, 75, 1).partition(",")[2])
    assert cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR).shape[1] == 80


def test_the_page_over_all_sequences_has_a_row_for_each():
    rows = [
        Row("mug", "mug/report.html", "data:,", "All checks passed.", True, {"IoU mean": "0.9"}),
        Row("cup", verdict="poses: the camera hardly moves.", good=False),
        Row("room", verdict="no mesh"),
    ]
    page = write_index(rows, ("IoU mean", "closed"))
    assert page.count('<a href="mug/report.html">') == 2 and "cup/report.html" not in page
    assert "<th>IoU mean</th>" in page and "closed" not in page
    assert "3 sequences" in page and "1 passed all checks" in page and page.count('<tr class="bad">') == 1


def test_what_comes_from_a_user_is_only_text_on_that_page_too():
    page = write_index([Row(HOSTILE, HOSTILE, HOSTILE, HOSTILE, False, {HOSTILE: HOSTILE})], (HOSTILE,))
    assert "<script>" not in page and "'\"1\"'" not in page
    assert page.count(html.escape(HOSTILE)) >= 5


@pytest.mark.parametrize("textured", [True, False])
def test_the_viewer_holds_mesh_path_and_plane(textured):
    mesh = ball()
    if textured:
        corners = np.random.default_rng(0).uniform(0, 15, (len(mesh.faces), 3, 2))
        mesh = TexturedMesh(mesh, corners, np.zeros((16, 16, 3), np.uint8))
    part = embed_viewer(mesh, PLACE.plane, ring(range(0, 360, 30)), "data:,")
    page = html.unescape(re.search(r'data-page="([^"]*)"', part)[1])
    scene = trimesh.load(
        trimesh.util.wrap_as_stream(base64.b64decode(re.search(r'base64_data="([^"]+)"', page)[1])), file_type="glb"
    )
    assert {"object", "cameras", "plane"} <= set(scene.geometry)
    low, high = scene.geometry["object"].bounds
    np.testing.assert_allclose([low[1], high[1]], [0, 1], atol=1e-5)  # y is up, and the plane is y = 0
    assert not re.search(r"(?:src|href)=[\"']https?:", page)


def test_what_comes_from_a_user_is_only_text():
    page = write_page(
        Report(
            HOSTILE,
            failures=(HOSTILE,),
            findings=tuple(judge(GOOD)),
            keyframes=(KeyframePictures(HOSTILE, {"mask": "data:,"}),),
            files={HOSTILE: HOSTILE},
            left_out=(HOSTILE,),
            path="<svg></svg>",
            scores={HOSTILE: {HOSTILE: HOSTILE}},
            costs=((HOSTILE, 1.0, 2.0),),
            settings={HOSTILE: HOSTILE},
            versions={HOSTILE: HOSTILE},
        )
    )
    assert "<script>" not in page
    assert page.count(html.escape(HOSTILE)) >= 10


def test_a_page_of_a_run_that_came_nowhere_has_its_sentence():
    page = write_page(Report("mug", failures=("poses: the camera hardly moves.",)))
    assert "its place" not in page
    assert "the camera hardly moves" in page
    assert "<h2>Keyframes" not in page and "<h2>Figures" not in page
