"""The mesh in a page, to be turned: the viewer that trimesh brings, in a frame of its own."""

from __future__ import annotations

import html
import io
from collections.abc import Sequence

import numpy as np
import trimesh
from PIL import Image
from trimesh.viewer.notebook import scene_to_html
from trimesh.visual.material import PBRMaterial

from threedfs.geometry.plane import axes_on
from threedfs.object.stand import turn_y_up
from threedfs.texture.textured import TexturedMesh, cut_charts
from threedfs.types import Mesh, Plane, View

_LONGEST_TEXTURE = 2048
"""Pixels along the longer side of the picture in the page."""
_AWAY = 1.6
"""Distance of the eye from the mesh, in diagonals of its box."""
_BUTTONS = (
    ("photographs", "paint('photographs')"),
    ("shaded", "paint('shaded')"),
    ("wires", "paint('wires')"),
    ("cameras", "toggle('cameras')"),
    ("plane", "toggle('plane')"),
)


def embed_viewer(surface: TexturedMesh | Mesh, plane: Plane, views: Sequence[View], picture: str) -> str:
    """Return a part of a page that shows the mesh, the camera's path and the support plane.

    Parameters
    ----------
    surface : TexturedMesh or Mesh
        Scene units.
    plane : Plane
        What it stands on.
    views : sequence of View
        The camera's path, in its order.
    picture : str
        Address of an image that stands in where a browser has no WebGL.
    """
    scene = _lay_out(surface, plane, np.stack([view.centre for view in views]))
    page = scene_to_html(scene)
    if _LOUD not in page:
        raise RuntimeError(f"trimesh {trimesh.__version__}: its viewer does not set {_LOUD}, which is replaced here.")
    page = page.replace(_LOUD, _QUIET)
    buttons = "".join(f'<button type="button" onclick="{call}">{label}</button>' for label, call in _BUTTONS)
    return (
        f'<div class="viewer"><img id="still" src="{picture}" alt="the mesh">'
        f'<iframe id="turn" title="the mesh, to be turned" hidden></iframe></div>'
        '<p id="flat" hidden>This browser cannot turn the mesh: it has no WebGL. Open mesh.glb in another viewer.</p>'
        f'<p class="buttons" id="buttons" hidden>{buttons} Drag to turn, scroll to come closer.</p>'
        f'<template id="viewer" data-page="{html.escape(page)}"></template><script>{_SCRIPT}</script>'
    )


_LOUD = "scene.background=new THREE.Color(0xffffff)"
_QUIET = "scene.background=new THREE.Color(0xf4f4f2);scene.add(new THREE.AmbientLight(0xffffff,0.4))"
"""In place of the viewer's white ground, so that light things stand out, and shadows are not black."""


def _lay_out(surface: TexturedMesh | Mesh, plane: Plane, path: np.ndarray) -> trimesh.Scene:
    """Return mesh, path and plane with y up; the eye looks at the mesh."""
    mesh = surface.mesh if isinstance(surface, TexturedMesh) else surface
    axes = axes_on(plane.normal)
    foot = -plane.offset * plane.normal

    def turn(points: np.ndarray) -> np.ndarray:
        return turn_y_up(Mesh((points - foot) @ axes.T, mesh.faces)).vertices

    vertices = turn(mesh.vertices)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    diagonal = float(np.linalg.norm(high - low))
    made = _paint(surface, vertices) if isinstance(surface, TexturedMesh) else trimesh.Trimesh(vertices, mesh.faces)
    scene = trimesh.Scene()
    scene.add_geometry(made, geom_name="object", node_name="object")
    scene.add_geometry(trimesh.load_path(turn(path)), geom_name="cameras", node_name="cameras")
    ground = trimesh.creation.box((2 * diagonal, 0.002 * diagonal, 2 * diagonal))
    ground.apply_translation([(low[0] + high[0]) / 2, -0.001 * diagonal, (low[2] + high[2]) / 2])
    ground.visual.face_colors = [200, 196, 186, 255]
    scene.add_geometry(ground, geom_name="plane", node_name="plane")
    scene.camera = trimesh.scene.Camera(name="eye", fov=(45, 45))  # without a name trimesh draws one, another each time
    scene.set_camera(angles=(-0.45, 0.6, 0), distance=_AWAY * diagonal, center=(low + high) / 2, fov=(45, 45))
    return scene


def _paint(surface: TexturedMesh, vertices: np.ndarray) -> trimesh.Trimesh:
    cut = cut_charts(surface)
    image = Image.fromarray(surface.image)
    image.thumbnail((_LONGEST_TEXTURE, _LONGEST_TEXTURE))
    small = io.BytesIO()
    image.save(small, format="JPEG", quality=85)
    material = PBRMaterial(baseColorTexture=Image.open(small), metallicFactor=0.0, roughnessFactor=1.0)
    made = trimesh.Trimesh(vertices[cut.vertex], cut.faces, process=False)
    made.visual = trimesh.visual.TextureVisuals(uv=cut.places, material=material)
    return made


_SCRIPT = """
(function () {
  var frame = document.getElementById('turn'), still = document.getElementById('still');
  var probe = document.createElement('canvas');
  function give_up() { document.getElementById('flat').hidden = false; }
  if (!(probe.getContext('webgl2') || probe.getContext('webgl'))) { give_up(); return; }
  frame.srcdoc = document.getElementById('viewer').dataset.page;
  frame.addEventListener('load', function () { wait(300); });
  function inside() { return frame.contentWindow; }
  function each(act) { inside().scene.traverse(act); }
  function isOf(thing, name) {
    for (; thing; thing = thing.parent) { if (thing.name && thing.name.indexOf(name) === 0) { return true; } }
    return false;
  }
  function wait(tries) {
    var ready = false;
    if (inside().scene) { each(function (thing) { ready = ready || thing.isMesh; }); }
    if (!ready) { if (tries) { setTimeout(function () { wait(tries - 1); }, 100); } else { give_up(); } return; }
    look(); toggle('cameras'); toggle('plane');
    still.hidden = true; frame.hidden = false; document.getElementById('buttons').hidden = false;
    inside().dispatchEvent(new Event('resize'));
  }
  function look() {
    var box = new (inside().THREE.Box3)(), centre = inside().controls.target;
    each(function (thing) {
      if (thing.isMesh && isOf(thing, 'object')) { box.expandByObject(thing); }
      if (thing.isLine || thing.isLineSegments) { thing.material.color.set(0x1f4e8c); }
    });
    box.getCenter(centre);
    inside().controls.update();
  }
  function toggle(name) {
    each(function (thing) {
      var drawn = thing.isMesh || thing.isLine || thing.isLineSegments;
      if (drawn && isOf(thing, name)) { thing.visible = !thing.visible; }
    });
    inside().render();
  }
  function paint(how) {
    each(function (thing) {
      if (!thing.isMesh || !isOf(thing, 'object')) { return; }
      var material = thing.material;
      if (material.userData.map === undefined) {
        material.userData.map = material.map; material.userData.color = material.color.clone();
      }
      var colored = how === 'photographs';
      material.map = colored ? material.userData.map : null;
      if (colored) { material.color.copy(material.userData.color); } else { material.color.set(0x7a7d82); }
      material.vertexColors = colored && !material.userData.map && !!thing.geometry.attributes.color;
      material.wireframe = how === 'wires';
      material.needsUpdate = true;
    });
    inside().render();
  }
  window.toggle = toggle; window.paint = paint;
})();
"""
