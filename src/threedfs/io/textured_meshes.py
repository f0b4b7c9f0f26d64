"""Meshes with a picture on them: OBJ with its material and PNG, and GLB."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import trimesh
from PIL import Image
from trimesh.exchange.obj import export_obj
from trimesh.visual.material import PBRMaterial, SimpleMaterial

from threedfs.errors import UserError
from threedfs.io.atomic import atomic
from threedfs.io.meshes import read_mesh
from threedfs.texture.textured import TexturedMesh

_DIGITS = 9
_HEADER = "made by threedfs"


def write_textured_obj(path: Path, textured: TexturedMesh) -> None:
    """Write NAME.obj, and beside it NAME.mtl and NAME.png, which it refers to."""
    material = SimpleMaterial(name=path.stem, image=Image.fromarray(textured.image), diffuse=(255, 255, 255))
    text, files = export_obj(
        _assemble(textured, material),
        include_normals=False,
        return_texture=True,
        digits=_DIGITS,
        mtl_name=f"{path.stem}.mtl",
        header=_HEADER,
    )
    for name, data in {path.name: text, **files}.items():
        with atomic(path.with_name(name)) as temporary:
            temporary.write_bytes(data.encode() if isinstance(data, str) else data)


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
    """Read what `write_textured_obj` wrote.

    Raises
    ------
    UserError
        As `threedfs.io.meshes.read_mesh`, or if there is no picture on the mesh.
    """
    mesh = read_mesh(path)
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
    return TexturedMesh(mesh, places[mesh.faces], texels)


def _assemble(textured: TexturedMesh, material: SimpleMaterial | PBRMaterial) -> trimesh.Trimesh:
    """Return the mesh for trimesh: vertices once for each place in the picture, u to the right and v up in [0, 1]."""
    faces = textured.mesh.faces
    height, width = textured.image.shape[:2]
    keys = np.concatenate([faces.reshape(-1, 1), textured.corners.reshape(-1, 2)], axis=1)
    kept, corner = np.unique(keys, axis=0, return_inverse=True)
    places = (kept[:, 1:] + 0.5) / [width, height]
    made = trimesh.Trimesh(
        textured.mesh.vertices[kept[:, 0].astype(np.int64)], corner.reshape(faces.shape), process=False
    )
    made.visual = trimesh.visual.TextureVisuals(
        uv=np.stack([places[:, 0], 1 - places[:, 1]], axis=1), material=material
    )
    return made
