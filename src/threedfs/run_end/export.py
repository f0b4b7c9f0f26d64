"""Write the mesh of an object upright and in its true size, for a printer or a viewer.

The format is that of the file's ending: stl, ply, obj or glb.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from scipy.spatial import cKDTree

from threedfs.errors import UserError
from threedfs.io.colored_meshes import read_colored_mesh, write_colored_mesh
from threedfs.io.meshes import read_mesh
from threedfs.io.scales import find_scale
from threedfs.io.textured_meshes import read_textured_obj, write_textured_glb, write_textured_obj
from threedfs.io.volumes import read_support
from threedfs.object.stand import height_on, place_upright, stand_up, turn_y_up
from threedfs.run_end.known import require_mesh
from threedfs.texture.levels import Level, make_levels
from threedfs.types import Mesh, Plane

_FORMATS = (".stl", ".ply", ".obj", ".glb")
_TEXTURED = {".obj": write_textured_obj, ".glb": write_textured_glb}


def export(sequence: Path, height: float | None, file: Path, method: str = "surface") -> float:
    """Write a sequence's mesh, with its texture or colours if it has any, standing on the plane z = 0.

    Returns its height, in the unit of the file.

    GLB and OBJ have textures; in GLB, y is up and the plane y = 0, as its readers expect.

    Parameters
    ----------
    sequence : Path
        Folder of its results.
    height : float or None
        Positive, in the unit that the file is to have; None takes the scale that the run found, and writes
        millimetres, GLB in metres.
    file : Path
    method : str
        Whose mesh it is.

    Raises
    ------
    UserError
        If there is no such mesh, the height is no positive number or not known, or the format is not known.
    """
    path, size, stand, turn = _prepare(sequence, height, file, method)
    textured, kind = path.parent / "textured" / "mesh.obj", file.suffix.lower()
    if kind in _TEXTURED and textured.is_file():
        painted = read_textured_obj(textured)
        _TEXTURED[kind](file, replace(painted, mesh=turn(stand(painted.mesh))))
    else:
        mesh, colors = read_colored_mesh(path)
        write_colored_mesh(file, turn(stand(mesh)), colors)
    return size


def export_levels(
    sequence: Path, height: float | None, file: Path, faces: Sequence[int], method: str = "surface"
) -> tuple[float, dict[Path, Level]]:
    """Write a sequence's mesh with fewer faces, as `export` does it, with the colours of its vertices and no texture.

    Parameters
    ----------
    sequence : Path
        Folder of its results.
    height : float or None
        As `export` takes it.
    file : Path
        NAME.ENDING for one number of faces; of several, each has a file NAME_FACES.ENDING of its own.
    faces : sequence of int
        The most that each mesh is to have.
    method : str
        Whose mesh it is.

    Returns
    -------
    height : float
        Of all of them, in the unit of the files.
    levels : dict of Path to Level
        By file, in that unit, z upwards.

    Raises
    ------
    UserError
        As `export`, or if the mesh is not closed.
    """
    path, size, stand, turn = _prepare(sequence, height, file, method)
    full, colors = read_colored_mesh(path)
    upright = stand(full)
    # the highest and the lowest vertex may be among those taken out
    levels = make_levels(upright, faces, lambda mesh: place_upright(mesh, size))
    if levels is None:
        raise UserError(f"{path}: expected a closed mesh to take faces from, got one that is not; leave --faces out.")
    nearest = cKDTree(upright.vertices)
    written = {}
    for count in dict.fromkeys(faces):
        own = file.with_name(f"{file.stem}_{count}{file.suffix}") if len(set(faces)) > 1 else file
        mesh = levels[count].mesh
        shades = None if colors is None else colors[nearest.query(mesh.vertices)[1]]
        write_colored_mesh(own, turn(mesh), shades)
        written[own] = levels[count]
    return size, written


def _prepare(
    sequence: Path, height: float | None, file: Path, method: str
) -> tuple[Path, float, Callable[[Mesh], Mesh], Callable[[Mesh], Mesh]]:
    """Return the path of a mesh, its height in the unit of a file, what stands it up at that height, z upwards, and
    what turns it as the file's format has it."""
    if height is not None and not 0 < height < float("inf"):
        raise UserError(f"height: expected a positive number, the height of the object, got {height}.")
    if file.suffix.lower() not in _FORMATS:
        raise UserError(
            f"{file}: expected a file that ends in {', '.join(_FORMATS)} or .ome.zarr, or --scene with a folder; "
            "rename it."
        )
    if not file.absolute().parent.is_dir():
        raise UserError(f"{file}: expected a folder to write into, found no {file.parent}; correct it, or make it.")
    path = require_mesh(sequence, method)
    plane, kind = read_support(sequence / "03_scene" / "support.json").plane, file.suffix.lower()
    size = _find_height(sequence, path, plane) * (1 if kind == ".glb" else 1000) if height is None else height

    def stand(mesh: Mesh) -> Mesh:
        return stand_up(mesh, plane, size)

    def turn(mesh: Mesh) -> Mesh:
        return turn_y_up(mesh) if kind == ".glb" else mesh

    return path, size, stand, turn


def _find_height(sequence: Path, path: Path, plane: Plane) -> float:
    """Return the height of a mesh in metres, by the scale that its run found."""
    scale = find_scale(sequence)
    if scale is None:
        raise UserError(
            f"{sequence}: expected --height, the object's true height, or a run with --tag, --board or --height that "
            "finds the size, found neither."
        )
    return scale.metres_per_unit * height_on(read_mesh(path), plane)
