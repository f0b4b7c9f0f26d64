"""The signed distance field of a sequence for viewers of volumes."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from threedfs.errors import UserError
from threedfs.geometry.plane import axes_on
from threedfs.io.meshes import read_mesh
from threedfs.io.ome_zarr import write_ome_zarr
from threedfs.io.scales import find_scale
from threedfs.io.volumes import read_support, read_volume
from threedfs.run_end.known import require_mesh

_NOTES = {
    "quantity": "signed distance",
    "sign": "positive in empty space, negative inside",
    "value_unit": "share of the clip distance",
}


def export_volume(sequence: Path, folder: Path, height: float | None = None, method: str = "surface") -> str:
    """Write the fused signed distance field around the object as OME-Zarr 0.5; return the unit of its lengths.

    Axes are those of the grid, which stands on the support plane: z is up. Lengths are metres where the size of the
    scene is known, by the height of the object or the scale that the run found; else scene units, and no unit is named.

    Parameters
    ----------
    sequence : Path
        Folder of its results.
    folder : Path
        Made, or replaced if it is OME-Zarr; its name ends in .ome.zarr or .zarr.
    height : float, optional
        Of the object, metres.
    method : str
        Whose mesh has that height.

    Raises
    ------
    UserError
        If the sequence has no such field or mesh, or something else is in the way.
    """
    path = sequence / "07_fusion/object.zarr.zip"
    if not path.is_file():
        raise UserError(f"{path}: expected the field of a run, found none; correct {sequence}, or run it again.")
    if not folder.absolute().parent.is_dir():
        raise UserError(f"{folder}: expected a folder to write into, found no {folder.parent}; correct it, or make it.")
    volume = read_volume(path)
    metres = _metres_per_unit(sequence, height, method)
    scale = metres or 1.0
    origin = [float(volume.grid.axis(axis)[0] * scale) for axis in range(3)]
    spacing, unit = volume.grid.spacing * scale, "meter" if metres else None
    write_ome_zarr(folder, volume.sdf, spacing, origin, unit, sequence.name, _NOTES)
    return unit or "scene unit"


def _metres_per_unit(sequence: Path, height: float | None, method: str) -> float | None:
    if height is None:
        scale = find_scale(sequence)
        return None if scale is None else scale.metres_per_unit
    mesh = read_mesh(require_mesh(sequence, method))
    along = mesh.vertices @ axes_on(read_support(sequence / "03_scene/support.json").plane.normal)[2]
    return height / float(np.ptp(along))
