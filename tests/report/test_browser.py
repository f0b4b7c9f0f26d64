"""Property: a report in a browser, opened as a file: what it draws, and that it neither fails nor asks the network.

Root on Debian gets Chromium installed for it if there is no browser.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess

import cv2
import numpy as np
import pytest
import trimesh

from threedfs.report.camera_path import draw_path
from threedfs.report.page import KeyframePictures, Report, wrap_page, write_page
from threedfs.report.pictures import embed_image
from threedfs.report.viewer import embed_viewer
from threedfs.texture.textured import TexturedMesh
from threedfs.types import Box, Camera, Mesh, Plane, Support, View

CAMERA = Camera(40, 30, 50.0, 50.0, 19.5, 14.5)
PLACE = Support(Plane(np.array([0.0, 0.0, 1.0]), 0.0), Box(np.eye(3), -np.ones(3), np.ones(3)), {})
HARM = "console.error('harm')"
HOSTILE = (
    f"<script>{HARM}</script>",
    f'"><img src=x onerror="{HARM}">',
    f"'><svg onload={HARM}>",
    f"');{HARM};('",
    f"</template></style></title><script>{HARM}</script>",
)
_SAYS = re.compile(r'CONSOLE[:(]\d+\)?\] "(.*)", source: ')
_OF_THE_DRIVER = "GL Driver Message"
_ASKS = re.compile(r'"initiator":"(?!not an origin)[^"]*".*?"url":"(https?://[^"]*)"')
"""A request of the page; what the browser asks by itself, such as the time or for an update, comes of no origin."""


def find_browser():
    """Return the path of a browser, or None."""
    return next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)


def install_browser():
    """Install Debian's Chromium; whether that went well is seen by looking for it again."""
    environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    patience = ["-o", "Acquire::Retries=0", "-o", "Acquire::http::Timeout=20", "-o", "Acquire::https::Timeout=20"]
    for words in (["update"], ["install", "--yes", "--no-install-recommends", "chromium"]):
        subprocess.run(["apt-get", "-qq", *patience, *words], env=environment, check=False)


@pytest.fixture(scope="module")
def browser():
    if find_browser() is None and os.geteuid() == 0 and shutil.which("apt-get"):
        install_browser()
    return find_browser() or pytest.skip("no chromium or google-chrome on the PATH, and none could be installed")


def visit(browser, page, folder):
    """Open a page from its file; return what the console says, what is asked of the network, and a picture."""
    (folder / "report.html").write_text(page, encoding="utf-8")
    flags = ["--headless", "--no-sandbox", "--no-first-run", "--disable-background-networking", "--disable-sync"]
    flags += ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--host-resolver-rules=MAP * ~NOTFOUND"]
    flags += ["--disable-component-update", f"--log-net-log={folder / 'net.json'}"]
    flags += [f"--user-data-dir={folder / 'profile'}", f"--screenshot={folder / 'page.png'}", "--window-size=900,800"]
    done = subprocess.run(
        [browser, *flags, "--enable-logging=stderr", "--virtual-time-budget=20000", (folder / "report.html").as_uri()],
        env={**os.environ, "HOME": str(folder)},
        capture_output=True,
        text=True,
        errors="replace",
        timeout=120,
        check=False,
    )
    picture = cv2.imread(str(folder / "page.png"))
    assert picture is not None, done.stderr[-2000:]
    said = [match[1] for match in map(_SAYS.search, done.stderr.splitlines()) if match]
    asked = set(_ASKS.findall((folder / "net.json").read_text(encoding="utf-8", errors="replace")))
    return (
        [message for message in said if _OF_THE_DRIVER not in message],
        asked,
        picture[..., ::-1],
    )


def ring():
    views = []
    for number, angle in enumerate(np.linspace(0, 2 * np.pi, 12, endpoint=False)):
        pose = np.eye(4)
        pose[:3, 3] = [-3 * np.cos(angle), -3 * np.sin(angle), -1.0]
        views.append(View(f"{number:06d}", CAMERA, pose))
    return views


def test_the_mesh_is_drawn_and_hostile_names_do_no_harm(tmp_path, browser):
    """The still picture is plain and the mesh red, so that what is red was drawn by the viewer."""
    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.5)
    mesh = Mesh(ball.vertices + np.array([0, 0, 0.5]), np.asarray(ball.faces))
    corners = np.random.default_rng(0).uniform(0, 15, (len(mesh.faces), 3, 2))
    painted = TexturedMesh(mesh, corners, np.full((16, 16, 3), (200, 20, 20), np.uint8))
    plain = embed_image(np.full((60, 90, 3), 244, np.uint8), 90)
    texts = {harm: harm for harm in HOSTILE}
    report = Report(
        HOSTILE[-1],
        failures=HOSTILE,
        viewer=embed_viewer(painted, PLACE.plane, ring(), plain),
        path=draw_path(ring(), {"000000"}, PLACE),
        keyframes=tuple(KeyframePictures(harm, {"mask": plain}) for harm in HOSTILE),
        files=texts,
        left_out=HOSTILE,
        scores={harm: texts for harm in HOSTILE},
        costs=tuple((harm, 1.0, 2.0) for harm in HOSTILE),
        settings=texts,
        versions=texts,
    )
    said, asked, picture = visit(browser, write_page(report), tmp_path)
    assert said == [] and asked == set()
    red = (picture[..., 0] > 60) & (picture[..., 0] > 2 * picture[..., 1].astype(int))
    assert 0.02 < red.mean() < 0.5
    assert picture[red].std(axis=0)[0] > 5  # it is lit from a side


def test_faults_harm_and_requests_would_be_seen(tmp_path, browser):
    """The same eyes on a page that has them all."""
    body = (
        '<img src="http://example.org/a.png"><script src="https://example.com/a.js"></script><script>fault()</script>'
        '<iframe src="https://example.org/frame"></iframe><script>fetch("http://example.net/data")</script>'
    )
    said, asked, _ = visit(browser, wrap_page("page", body + "".join(HOSTILE[:2])), tmp_path)
    assert asked == {
        "http://example.org/a.png",
        "https://example.com/a.js",
        "https://example.org/frame",
        "http://example.net/data",
    }
    assert said.count("harm") == 2 and any("fault is not defined" in message for message in said)
