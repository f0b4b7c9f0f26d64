"""`threedfs run`: from a video to a mesh with one command; and the same from Python."""

from __future__ import annotations

import sys
import time
from argparse import Namespace
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from threedfs.cli.progress import tell_time
from threedfs.cli.request import (
    INTERRUPTED,
    QUALITIES,
    Request,
    count_cores,
    list_requests,
    read_scale,
    read_settings,
    stem_of,
)
from threedfs.cli.workflow import run_workflow
from threedfs.errors import UserError
from threedfs.io.scales import find_scale, tell_scale
from threedfs.report.findings import sum_up
from threedfs.run_end.export import export
from threedfs.run_end.known import find_masks, find_method
from threedfs.run_end.report import find_out
from threedfs.run_end.results import Results, open_results
from threedfs.run_end.summary import read_summary

_MESHES = {"mesh": "mesh.glb", "detail": "mesh.ply"}


def run(arguments: Namespace) -> int:
    """Reconstruct videos and say where the meshes are; return the exit status.

    Raises
    ------
    UserError
        If something that was asked for cannot be.
    """
    begun = time.monotonic()
    scale = read_scale(arguments.tag, arguments.board, arguments.height)
    requests, changes = list_requests(arguments.video, scale), read_settings(arguments.set or [])
    out = Path(arguments.out).expanduser().resolve()
    for request in requests:
        if request.name != stem_of(request.source):
            print(f"{request.source.name} is called {request.name} in the results.", flush=True)
    outcome = run_workflow(requests, changes, out, arguments.quality, arguments.cores)
    if outcome.interrupted:
        print("threedfs: not finished; run the same command again to resume.", file=sys.stderr)
        return INTERRUPTED
    failed = [request for request in requests if outcome.names(request.name)]
    for request in requests:
        # after a failure meshes may be of an earlier run; of several sequences, one that is not named has ended well
        if not outcome.status or (failed and request not in failed):
            _conclude(request, out)
        elif not outcome.refused:
            _name_report(out / "results" / request.name)
    if not outcome.status:
        print(f"time     {tell_time(time.monotonic() - begun)}")
    for sentence in outcome.faults:
        print(f"threedfs: {sentence}", file=sys.stderr)
    if outcome.status and not outcome.faults:
        print(f"threedfs: the run failed; its last words are in {outcome.log}.", file=sys.stderr)
    return 1 if outcome.status else 0


def reconstruct(
    video: str | Path,
    out: str | Path = ".",
    *,
    quality: str = "normal",
    cores: int | None = None,
    settings: Mapping[str, Any] | None = None,
    scale: Mapping[str, Any] | None = None,
) -> Results:
    """Reconstruct the object of a video, or of a folder of photos; what was done before is not done again.

    Parameters
    ----------
    video : str or Path
    out : str or Path
        Folder that gets `results/NAME`.
    quality : str
        draft, normal or fine.
    cores : int, optional
        All, if not given.
    settings : mapping, optional
        Parameters that differ from the defaults, by stage: `{"depth": {"iterations": 5}}`.
    scale : mapping, optional
        What tells the size: `{"tag": "40mm"}`, `{"board": {"corners": [9, 6], "square": "25mm"}}` or
        `{"height": "95mm"}`.

    Raises
    ------
    UserError
        If the run failed, with the sentence that says why.
    """
    if quality not in QUALITIES:
        raise UserError(f"quality: expected one of {', '.join(QUALITIES)}, got {quality}.")
    if cores is not None and cores < 1:
        raise UserError(f"cores: expected a whole number of at least 1, got {cores}.")
    requests, folder = list_requests([str(video)], scale), Path(out).expanduser().resolve()
    outcome = run_workflow(requests, dict(settings or {}), folder, quality, cores or count_cores())
    if outcome.interrupted:
        raise KeyboardInterrupt
    if outcome.status:
        raise UserError(" ".join(outcome.faults) or f"the run failed; see {outcome.log}.")
    return open_results(folder / "results" / requests[0].name)


def _conclude(request: Request, out: Path) -> None:
    """Say what a run made of a video, and write the files for printing if its size is known."""
    folder = out / "results" / request.name
    summary = read_summary(folder)
    methods = summary.methods if summary else None  # what others left in the folder is of earlier runs
    method, masks = find_method(folder, methods), find_masks(folder, methods)
    if method is not None:
        for what, name in _MESHES.items():
            if (folder / "11_object" / method / name).is_file():
                print(f"{what:8} {folder / '11_object' / method / name}")
        if request.scale is not None:
            _export_to_scale(folder, out / request.name, method)
    elif request.scale is not None:
        print("stl      none: no method with a mesh was run")
    if masks is not None:
        print(f"masks    {masks}, {len(list(masks.glob('*.png')))} of them")
    _name_report(folder)
    try:
        findings = find_out(folder, methods)
    except (UserError, KeyError, ValueError, OSError) as fault:  # results were damaged: the meshes are named above
        print(f"verdict  none, as results cannot be read: {fault}")
        return
    if findings:
        print(f"verdict  {sum_up(findings)}")
    for finding in findings:
        if not finding.good:
            print(f"         {finding.advice}")


def _export_to_scale(folder: Path, stem: Path, method: str) -> None:
    scale = find_scale(folder)
    if scale is None:
        print("stl      none: the size was not found")
        return
    print(f"size     {tell_scale(scale)}")
    for ending, unit in ((".stl", "mm"), (".glb", "m")):
        file = stem.with_name(stem.name + ending)
        try:
            size = export(folder, None, file, method)
            print(f"{ending[1:]:8} {file}, {size:.4g} {unit} tall")
        except OSError as fault:
            print(f"{ending[1:]:8} none: {file} cannot be written: {fault.strerror}")


def _name_report(folder: Path) -> None:
    if (folder / "report.html").is_file():
        print(f"report   {folder / 'report.html'}")
