"""The command line of `threedfs`."""

from __future__ import annotations

import argparse
import io
import sys
import webbrowser
from collections.abc import Sequence
from pathlib import Path

import threedfs
from threedfs.cli import store
from threedfs.cli.clean import add_clean
from threedfs.cli.export import add_export
from threedfs.cli.request import INTERRUPTED, QUALITIES, count_cores
from threedfs.errors import UserError

METHOD_LINES = {
    "surface": "confirmed depth and the hull of the masks: the mesh to keep, with photographs on it",
    "sdf_2d3d_voxel": "the fused field inside of the voxels of the joint cut: the paper's mesh",
    "gc_2d3d_pixel": "masks by the joint cut of images and voxels",
    "gc_2d3d_voxel": "the voxels of the joint cut",
    "gc_select": "their largest piece",
    "gc_2d": "masks by a cut of the images alone, by colour",
    "spectral_matting": "masks by spectral matting of each image alone, which the paper tried",
    "volumetric_gc": "voxels cut by colour alone",
    "fused_sdf": "the depth maps fused, each view weighed by how far it is trusted",
    "deformed_sdf": "the same, its surface moved onto surface points",
    "tsdf": "the weighted average of KinectFusion",
    "soft_maximum": "the paper's soft maximum as printed (Eq. 15)",
    "hard_maximum": "the hard maximum (Eq. 13)",
    "poisson": "Poisson reconstruction of the surface points alone",
}


_SCORED = ("masks", "mesh", "cameras")


def main(words: Sequence[str] | None = None) -> int:
    """Do what the command line says; return the exit status."""
    arguments = _make_parser().parse_args(words)
    if isinstance(sys.stdout, io.TextIOWrapper):  # in a pipe or a file, too, what goes wrong comes after what went well
        sys.stdout.reconfigure(line_buffering=True)
    try:
        return arguments.act(arguments)
    except UserError as fault:
        print(f"threedfs: {str(fault).removeprefix('threedfs: ')}", file=sys.stderr)
        return 1
    except OSError as fault:
        if isinstance(fault, BrokenPipeError):  # the reader of our output, such as head, has gone
            return 1
        print(f"threedfs: {fault.filename or 'a file'}: {fault.strerror}.", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("threedfs: stopped.", file=sys.stderr)
        return INTERRUPTED


def _make_parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="threedfs", description="Film one object; get a closed mesh of it alone, and a mask in every keyframe."
    )
    parser.add_argument("--version", action="version", version=f"threedfs {threedfs.__version__}")
    actions = parser.add_subparsers(required=True, metavar="COMMAND")

    run = actions.add_parser("run", help="reconstruct a video or a folder of photos")
    run.add_argument("video", nargs="+", help="a video (mp4, mov, ...) or a folder of photos of one object")
    run.add_argument("--out", default=".", help="folder that gets results/NAME and the files to print (here)")
    size = run.add_mutually_exclusive_group()
    size.add_argument(
        "--height", help="true height of the object, as 95mm or 9.5cm, mm without a unit: writes NAME.stl and NAME.glb"
    )
    size.add_argument("--tag", metavar="SIDE", help="the same by an ArUco or AprilTag marker in the scene, as 40mm")
    size.add_argument("--board", metavar="CxR:SIDE", help="the same by a checkerboard, C x R inner corners: 9x6:25mm")
    run.add_argument("--quality", choices=QUALITIES, default="normal", help="draft is fast, fine is slow")
    run.add_argument("--cores", type=_read_cores, default=count_cores(), help="cores to use (all)")
    run.add_argument("--set", action="append", metavar="STAGE.KEY=VALUE", help="change a parameter; can be repeated")
    run.set_defaults(act=_run)

    check = actions.add_parser("check", help="tell in seconds whether a video or photos can be used")
    check.add_argument("video", nargs="+", help="a video (mp4, mov, ...) or a folder of photos of one object")
    check.set_defaults(act=_check)

    show = actions.add_parser("show", help="open the report of a sequence in the browser")
    show.add_argument("results", type=Path, help="its folder, as results/my")
    show.set_defaults(act=_show)

    add_export(actions)
    add_clean(actions)

    score = actions.add_parser("score", help="score masks, a mesh or cameras of any program against a truth")
    for what, form in (("masks", "folder of PNG"), ("mesh", "ply, obj, stl or glb"), ("cameras", "as the truth's")):
        score.add_argument(f"--{what}", type=Path, help=f"what is scored: {form}")
        score.add_argument(f"--true-{what}", type=Path, help="what it is scored against")
    score.add_argument("--csv", type=Path, help="write the figures to this file as well")
    score.set_defaults(act=_score)

    store.add_parser(actions)

    methods = actions.add_parser("methods", help="list the ways to a mesh or masks")
    methods.set_defaults(act=_list_methods)
    return parser


def _run(arguments: argparse.Namespace) -> int:
    # numeric libraries take a second to import: --help need not wait for them
    from threedfs.cli.run import run

    return run(arguments)


def _check(arguments: argparse.Namespace) -> int:
    from threedfs.cli.check import check

    return check(arguments)


def _show(arguments: argparse.Namespace) -> int:
    page = (arguments.results / "report.html").resolve()
    if not page.is_file():
        raise UserError(
            f"{page}: expected the report of a run, found none; correct the folder, or run the video first."
        )
    print(page)
    webbrowser.open(page.as_uri())
    return 0


def _score(arguments: argparse.Namespace) -> int:
    from threedfs.run_end.score import score_cameras, score_masks, score_mesh

    given = {what: (getattr(arguments, what), getattr(arguments, f"true_{what}")) for what in _SCORED}
    for what, (own, true) in given.items():
        if (own is None) != (true is None):
            raise UserError(f"score: expected --{what} and --true-{what} together, got one of them.")
    figures = []
    if given["masks"][0]:
        figures += score_masks(*given["masks"])
    if given["mesh"][0]:
        figures += score_mesh(*given["mesh"], *given["cameras"])
    if given["cameras"][0]:
        figures += score_cameras(*given["cameras"])
    if not figures:
        raise UserError("score: expected --masks, --mesh or --cameras, each with its truth, got none of them.")
    for figure in figures:
        if not figure.keyframe:
            print(f"{figure.name:28} {figure.value:.4g} {'' if figure.unit == '1' else figure.unit}".rstrip())
    if arguments.csv:
        from threedfs.evaluate.scores import Metric
        from threedfs.io.metrics import write_metrics

        rows = [Metric(figure.name, figure.value, figure.unit, "", "", "", figure.keyframe) for figure in figures]
        write_metrics(arguments.csv, rows)
    return 0


def _list_methods(arguments: argparse.Namespace) -> int:
    for name, meaning in METHOD_LINES.items():
        print(f"{name:16} {meaning}")
    return 0


def _read_cores(text: str) -> int:
    if not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"expected a whole number of at least 1, got {text!r}")
    return int(text)


if __name__ == "__main__":
    sys.exit(main())
