"""`threedfs export`: results in the formats of other programs."""

from __future__ import annotations

import argparse
from pathlib import Path

from threedfs.cli.request import read_height
from threedfs.errors import UserError

_BINARY = ("colmap", "nerfstudio", "openmvs", "rgba")
_MASKS = (*_BINARY, "alpha")
_FEWEST = 100
"""Faces that a mesh is simplified to at most; with fewer nothing of its shape is left."""


def add_export(actions: argparse._SubParsersAction) -> None:
    """Add the subcommand."""
    parser = actions.add_parser("export", help="write a mesh to scale, or the scene or the volume, for other programs")
    parser.add_argument("results", type=Path, help="folder of a sequence, as results/my")
    parser.add_argument(
        "file", type=Path, help="what to write: a mesh (stl, ply, obj, glb), a volume (.ome.zarr), or a folder"
    )
    parser.add_argument(
        "--height",
        help="true height, as 95mm (mm without a unit), if the run did not find the size; meshes are in mm, glb and "
        "volumes in metres",
    )
    parser.add_argument(
        "--faces",
        type=_read_faces,
        help="the most faces that the mesh is to have, as 20000; of several, as 5000,20000, each has a file of its own",
    )
    parser.add_argument("--scene", action="store_true", help="write frames, masks, cameras for other tools")
    parser.add_argument(
        "--masks",
        choices=(*_MASKS, "all"),
        action="append",
        help="with --scene, whom masks are for; can be repeated (colmap and nerfstudio); alpha is soft at the "
        "outline, all is the other four",
    )
    parser.add_argument("--method", default="surface", help="whose mesh (surface)")
    parser.set_defaults(act=export)


def export(arguments: argparse.Namespace) -> int:
    """Do what the subcommand says; return the exit status.

    Raises
    ------
    UserError
        If words do not go together, or there is nothing to write.
    """
    if arguments.masks and not arguments.scene:
        raise UserError("export: expected --scene with --masks, got --masks alone; masks go with a scene's images.")
    if arguments.scene:
        return _export_scene(arguments)
    if arguments.file.suffix.lower() == ".zarr":
        return _export_volume(arguments)
    return _export_mesh(arguments)


def _export_scene(arguments: argparse.Namespace) -> int:
    # what is numeric takes a second to import: --help need not wait for it
    from threedfs.io.scales import find_scale
    from threedfs.progress import Progress
    from threedfs.run_end.export_scene import export_scene

    if arguments.height or arguments.faces:
        raise UserError(
            f"export: expected --scene or {'--height' if arguments.height else '--faces'}, got both; a scene has the "
            "size that its run found, and no mesh."
        )
    asked = arguments.masks or ["colmap", "nerfstudio"]
    kinds = tuple(dict.fromkeys(kind for name in asked for kind in (_BINARY if name == "all" else (name,))))
    progress = Progress("export")
    count = export_scene(
        arguments.results, arguments.file, arguments.method, kinds, track=lambda views: progress.track(views, "frame")
    )
    unit = "scene units" if find_scale(arguments.results) is None else "metres"
    print(f"{arguments.file}: {count} frames, their masks and cameras, in {unit}")
    return 0


def _export_volume(arguments: argparse.Namespace) -> int:
    from threedfs.run_end.export_volume import export_volume

    if arguments.faces:
        raise UserError(f"export: expected --faces with a mesh, got it with the volume {arguments.file}.")
    height = None if arguments.height is None else read_height(arguments.height) / 1000
    unit = export_volume(arguments.results, arguments.file, height, arguments.method)
    print(f"{arguments.file}: signed distance field, in {'metres' if unit == 'meter' else 'scene units'}")
    return 0


def _export_mesh(arguments: argparse.Namespace) -> int:
    from threedfs.run_end.export import export, export_levels

    in_metres = arguments.file.suffix.lower() == ".glb"
    unit = "m" if in_metres else "mm"
    size = None
    if arguments.height is not None:
        size = read_height(arguments.height) / (1000 if in_metres else 1)
        _tell_other_size(arguments.results, arguments.height)
    if not arguments.faces:
        tall = export(arguments.results, size, arguments.file, arguments.method)
        print(f"{arguments.file}: {tall:.4g} {unit} tall")
        return 0
    tall, levels = export_levels(arguments.results, size, arguments.file, arguments.faces, arguments.method)
    for file, level in levels.items():
        mean, largest = (error * (1000 if in_metres else 1) for error in (level.mean_error, level.largest_error))
        print(
            f"{file}: {len(level.mesh.faces)} faces, closed, {tall:.4g} {unit} tall; the full mesh is {mean:.2g} mm "
            f"away in the mean, {largest:.2g} mm at most"
        )
    return 0


def _tell_other_size(results: Path, height: str) -> None:
    """Say that the size which a run found is not used; it may have been forgotten."""
    from threedfs.io.scales import find_scale

    if find_scale(results) is not None:
        print(f"--height {height} is used, not the size that the run of {results} found.")


def _read_faces(text: str) -> tuple[int, ...]:
    words = text.split(",")
    if not all(word.strip().isdigit() and int(word) >= _FEWEST for word in words):
        raise argparse.ArgumentTypeError(f"expected whole numbers of at least {_FEWEST}, as 5000,20000, got {text!r}")
    return tuple(int(word) for word in words)
