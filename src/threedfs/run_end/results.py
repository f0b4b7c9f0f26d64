"""The results of a sequence as arrays."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from threedfs.errors import UserError
from threedfs.io.colored_meshes import read_colored_mesh
from threedfs.io.crops import read_crops
from threedfs.io.depth_maps import DepthMap, read_depth_map
from threedfs.io.images import read_mask
from threedfs.io.keyframes import read_keyframes
from threedfs.io.metrics import read_metrics
from threedfs.io.poses import read_poses
from threedfs.io.scales import Scale, find_scale
from threedfs.io.volumes import Volume, read_support, read_volume
from threedfs.types import Keyframe, Mesh, Support, View


@dataclass(frozen=True)
class Results:
    """What a run made of a sequence; read from its folder when asked for.

    World coordinates are scene units, right-handed; cameras look along z, x right and y down; pixel centres are whole
    numbers (docs/conventions.md).

    Attributes
    ----------
    folder : Path
        results/SEQUENCE.
    """

    folder: Path

    def mesh(self, method: str = "surface") -> tuple[Mesh, np.ndarray | None]:
        """Return the mesh of a method, and the colours (V, 3) uint8 RGB of its vertices, None where it has none."""
        return read_colored_mesh(self._find(f"11_object/{method}/mesh.ply", f"a mesh by the method {method}"))

    def masks(self, method: str = "surface") -> dict[str, np.ndarray]:
        """Return the masks (H, W) bool of a method, by keyframe, of the size of the video or the photos."""
        folder = self._find(f"11_object/{method}/masks", f"masks by the method {method}")
        return {path.stem: read_mask(path) for path in sorted(folder.glob("*.png"))}

    def cameras(self) -> dict[str, View]:
        """Return the camera of every frame that has one, by name; of undistorted working frames."""
        return {view.name: view for view in read_poses(self._find("02_poses/poses.json", "cameras")).views}

    def keyframes(self) -> dict[str, Keyframe]:
        """Return the keyframes by name, as views of their crops, with their neighbours and depth ranges."""
        return read_keyframes(self._find("04_crops/keyframes.json", "keyframes"))

    def image(self, name: str) -> np.ndarray:
        """Return the crop (H, W, 3) uint8 RGB of a keyframe or a neighbour of one."""
        return read_crops(self._find("04_crops/crops.zarr.zip", "crops")).image(name)

    def depth(self, name: str) -> DepthMap:
        """Return the dense depth of a keyframe, and its confidence, by the pixels of its crop."""
        return read_depth_map(self._find(f"06_depth/{name}.zarr.zip", f"the depth of a keyframe {name}"))

    def volume(self) -> Volume:
        """Return the fused signed distance field around the object."""
        return read_volume(self._find("07_fusion/object.zarr.zip", "a fused field"))

    def support(self) -> Support:
        """Return the plane that the object stands on, and the box around it."""
        return read_support(self._find("03_scene/support.json", "a support plane"))

    def scale(self) -> Scale | None:
        """Return how many metres a scene unit is and how that was found; None where the run was told no size."""
        return find_scale(self.folder)

    def metrics(self) -> dict[tuple[str, str], float]:
        """Return the figures of the whole sequence by method and name; the method is empty for what all share."""
        tables = sorted((self.folder / "12_evaluate").rglob("*.csv"))
        rows = (metric for path in tables for metric in read_metrics(path))
        return {(row.method, row.name): row.value for row in rows if not row.keyframe}

    def _find(self, name: str, what: str) -> Path:
        path = self.folder / name
        if not path.exists():
            raise UserError(f"{path}: expected {what}, found none; run the sequence, or correct the name.")
        return path


def open_results(folder: str | Path) -> Results:
    """Open the results of a sequence.

    Parameters
    ----------
    folder : str or Path
        results/SEQUENCE.

    Raises
    ------
    UserError
        If there are none.
    """
    folder = Path(folder)
    if not (folder / "02_poses").is_dir() and not (folder / "01_frames").is_dir():
        raise UserError(f"{folder}: expected the results of a sequence, as results/my, found none there.")
    return Results(folder)
