"""Meshes with a picture on them: OBJ with its material and PNG, and GLB."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import trimesh
from PIL import Image
from trimesh.visual.material import PBRMaterial

from threedfs.errors import UserError
from threedfs.io.atomic import atomic
from threedfs.io.meshes import read_mesh
from threedfs.texture.textured import TexturedMesh, cut_charts, scale_places
from threedfs.types import Mesh


def write_textured_obj(path: Path, textured: TexturedMesh) -> None:
    """Write NAME.obj, and beside it NAME.mtl and NAME.png, which it refers to.

    Vertices and places in the picture have indices of their own, so that the mesh is not cut along the charts.
    """
    places, corner = np.unique(textured.corners.reshape(-1, 2), axis=0, return_inverse=True)
    pairs = np.stack([textured.mesh.faces.ravel(), corner.ravel()], axis=1).reshape(-1, 6) + 1
    lines = [f"# made by threedfs\nmtllib {path.stem}.mtl\nusemtl {path.stem}"]
    lines += [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in textured.mesh.vertices]
    lines += [f"vt {u:.9g} {v:.9g}" for u, v in scale_places(places, textured.image)]
    lines += [f"f {a}/{at} {b}/{bt} {c}/{ct}" for a, at, b, bt, c, ct in pairs]
    material = f"newmtl {path.stem}\nKa 1 1 1\nKd 1 1 1\nKs 0 0 0\nillum 1\nmap_Kd {path.stem}.png\n"
    with atomic(path) as temporary:
        temporary.write_text("\n".join(lines) + "\n", encoding="utf-8")
    with atomic(path.with_suffix(".mtl")) as temporary:
        temporary.write_text(material, encoding="utf-8")
    with atomic(path.with_suffix(".png")) as temporary:
        Image.fromarray(textured.image).save(temporary, format="png")


def write_textured_glb(path: Path, textured: TexturedMesh) -> None:
    """Write a GLB that holds the picture; by the format's convention y is up and the object stands on y = 0."""
    material = PBRMaterial(
        name=path.stem,
        baseColorTexture=Image.fromarray(textured.image),
        metallicFactor=0.0,
        roughnessFactor=1.0,
    )
    with atomic(path) as temporary:
        temporary.write_bytes(_assemble(textured, material).export(file_type="glb"))


def read_textured_obj(path: Path) -> TexturedMesh:
    """Read what `write_textured_obj` wrote; vertices at one place are one, as trimesh cuts the mesh along the charts.

    Raises
    ------
    UserError
        As `threedfs.io.meshes.read_mesh`, or if there is no picture on the mesh.
    """
    cut = read_mesh(path)
    visual = trimesh.load(path, force="mesh", process=False).visual
    image = getattr(getattr(visual, "material", None), "image", None)
    if image is None or not path.with_suffix(".mtl").is_file():  # without it trimesh makes up a grey picture
        raise UserError(
            f"{path}: expected a mesh with a texture, found none on it; its .mtl and .png belong beside it: copy all "
            "three, or run the sequence again."
        )
    texels = np.asarray(image.convert("RGB"))
    height, width = texels.shape[:2]
    places = np.stack([visual.uv[:, 0] * width, (1 - visual.uv[:, 1]) * height], axis=1) - 0.5
    vertices, joined = np.unique(cut.vertices, axis=0, return_inverse=True)
    return TexturedMesh(Mesh(vertices, joined.ravel()[cut.faces]), places[cut.faces], texels)


def _assemble(textured: TexturedMesh, material: PBRMaterial) -> trimesh.Trimesh:
    """Return the mesh for trimesh, vertices once for each place in the picture."""
    cut = cut_charts(textured)
    made = trimesh.Trimesh(textured.mesh.vertices[cut.vertex], cut.faces, process=False)
    made.visual = trimesh.visual.TextureVisuals(uv=cut.places, material=material)
    return made
