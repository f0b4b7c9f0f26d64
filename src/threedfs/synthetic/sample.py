"""The sample that the project ships: a gnome on a wooden table, filmed once around."""

from __future__ import annotations

from threedfs.synthetic.film import Film
from threedfs.synthetic.light import Light
from threedfs.synthetic.objects.gnome import make_gnome
from threedfs.synthetic.path import HandheldPath
from threedfs.synthetic.room import Room
from threedfs.synthetic.scene import Scene
from threedfs.synthetic.sensor import Sensor
from threedfs.synthetic.solid import Material
from threedfs.synthetic.table import Sheet, Table
from threedfs.synthetic.textures import plain, printed, speckled, wood, woven
from threedfs.types import Camera

# One mask every so many frames; constant rate factor of the video (chosen for about 4 MB).
MASK_STEP = 10
QUALITY = 19


def sample_film() -> Film:
    """Return the sample: 8 s of 640x480 at 30 frames per second."""
    camera = Camera(640, 480, 525.0, 525.0, 319.5, 239.5)
    path = HandheldPath(
        duration=8.0,
        turns=1.04,
        start=-100.0,
        distance=(0.55, 0.70),
        elevation=(22.0, 48.0),
        target=(0.0, 0.0, 0.085),
        seed=3,
    )
    return Film(
        scene=_scene(),
        camera=camera,
        path=path,
        sensor=Sensor(gain=1.5, seed=11),
        frames=240,
        rate=30,
        shutter=1 / 150,
        samples=4,
    )


def _scene() -> Scene:
    oak = Material(wood((0.42, 0.25, 0.12), (0.13, 0.062, 0.026), 0.105, seed=21), 0.05, 60)
    page = Material(printed((0.78, 0.76, 0.70), (0.03, 0.03, 0.035), 0.0070, seed=33), 0.03, 30)
    leaflet = Material(printed((0.70, 0.72, 0.72), (0.03, 0.06, 0.16), 0.0078, seed=31), 0.05, 40)
    card = Material(printed((0.72, 0.63, 0.42), (0.25, 0.05, 0.06), 0.011, seed=23), 0.06, 50)
    napkin = Material(woven((0.17, 0.30, 0.33), (0.50, 0.50, 0.44), 0.0027, seed=24))
    note = Material(plain((0.78, 0.68, 0.20), 0.05, 0.03, seed=25))
    table = Table(
        half=(0.62, 0.47),
        material=oak,
        sheets=(
            Sheet((-0.27, 0.14), (0.148, 0.105), 24.0, page),
            Sheet((0.30, -0.21), (0.148, 0.105), -61.0, leaflet),
            Sheet((0.22, 0.20), (0.11, 0.11), 12.0, napkin),
            Sheet((-0.24, -0.22), (0.070, 0.050), -18.0, card),
            Sheet((-0.02, 0.27), (0.038, 0.038), 41.0, note),
        ),
    )
    room = Room(
        low=(-2.3, -1.9, -0.74),
        high=(2.1, 2.2, 1.8),
        floor=speckled((0.30, 0.25, 0.21), (0.13, 0.12, 0.14), 0.03, 0.4, seed=26),
        wall_seed=27,
    )
    light = Light((0.75, -0.55, 1.35), 0.16, (1.9, 1.75, 1.52), (0.20, 0.215, 0.24))
    return Scene(make_gnome(), table, room, light)
