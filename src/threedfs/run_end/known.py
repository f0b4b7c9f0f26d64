"""What lies in a folder of results: how far its run came, and which mesh and masks to look at."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from threedfs.errors import UserError
from threedfs.io.keyframes import read_keyframes
from threedfs.io.poses import Poses, read_poses
from threedfs.io.volumes import read_support
from threedfs.params.configuration import MESH_METHODS
from threedfs.types import Keyframe, Support

MASK_METHODS = tuple(dict.fromkeys(["surface", "gc_2d3d_pixel", "gc_2d", *MESH_METHODS, "spectral_matting"]))
"""Methods by whose masks one would look at, the best first."""


def require_mesh(sequence: Path, method: str) -> Path:
    """Return the path of a sequence's mesh by a method.

    Raises
    ------
    UserError
        If there is no such sequence, or it has no mesh by the method.
    """
    if not sequence.is_dir():
        raise UserError(f"{sequence}: expected the folder of a sequence, as results/my, found none; correct it.")
    path = sequence / "11_object" / method / "mesh.ply"
    if path.is_file():
        return path
    others = sorted(mesh.parent.name for mesh in sequence.glob("11_object/*/mesh.ply"))
    if others:
        raise UserError(
            f"{sequence}: expected a mesh by the method {method}, found {'one' if len(others) == 1 else 'those'} by "
            f"{', '.join(others)}; correct --method, or run that method first."
        )
    raise UserError(f"{path}: expected the mesh of a run, found none; run the sequence first.")


@dataclass(frozen=True)
class Known:
    """What a run left, None where it did not come so far.

    Attributes
    ----------
    poses : Poses or None
    place : Support or None
        Support plane and box of the object.
    keyframes : mapping of str to Keyframe
        By name, in the geometry of the crops.
    method : str or None
        Whose mesh is the one to look at.
    """

    poses: Poses | None = None
    place: Support | None = None
    keyframes: Mapping[str, Keyframe] = field(default_factory=dict)
    method: str | None = None


def gather(folder: Path, methods: Collection[str] | None = None, stale: Collection[str] = ()) -> Known:
    """Read what a folder of results holds; what is damaged is as if it were not there.

    Parameters
    ----------
    folder : Path
    methods : collection of str, optional
        Those of the run; all, if not given.
    stale : collection of str
        Paths that are of an earlier run.
    """
    places = {
        "poses": (folder / "02_poses/poses.json", read_poses),
        "place": (folder / "03_scene/support.json", read_support),
        "keyframes": (folder / "04_crops/keyframes.json", read_keyframes),
    }
    found: dict[str, Any] = {}
    for name, (path, read) in places.items():
        try:
            found |= {name: read(path)} if path.is_file() and str(path) not in stale else {}
        except UserError:  # damaged: the run says so when it needs it
            continue
    if "poses" not in found:
        return Known()
    return Known(**found, method=find_method(folder, methods))


def find_method(folder: Path, methods: Collection[str] | None = None) -> str | None:
    """Return the method whose mesh of a sequence is the one to look at, None without any mesh.

    Parameters
    ----------
    folder : Path
        Of its results.
    methods : collection of str, optional
        Those of the run; all, if not given.
    """
    meshes = (name for name in choose(MESH_METHODS, methods) if (folder / "11_object" / name / "mesh.ply").is_file())
    return next(meshes, None)


def find_masks(folder: Path, methods: Collection[str] | None = None) -> Path | None:
    """Return the folder of a sequence's masks to look at, None without any; parameters as `find_method`."""
    folders = (folder / "11_object" / name / "masks" for name in choose(MASK_METHODS, methods))
    return next((path for path in folders if path.is_dir()), None)


def choose(names: Sequence[str], methods: Collection[str] | None) -> list[str]:
    """Return those names that are methods of the run, of which None has all."""
    return [name for name in names if methods is None or name in methods]
