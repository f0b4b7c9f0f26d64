"""The report of a sequence: one page to look at, from what lies in its folder of results."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from threedfs.evaluate.costs import cost_figures
from threedfs.evaluate.doubts import find_doubts
from threedfs.evaluate.figures import soundness_figures
from threedfs.evaluate.scores import Metric
from threedfs.geometry.projection import normals_from_depth
from threedfs.io.atomic import atomic
from threedfs.io.colored_meshes import read_colored_mesh, read_vertex_property
from threedfs.io.crops import read_crops
from threedfs.io.depth_maps import read_depth_map
from threedfs.io.meshes import read_mesh
from threedfs.io.scales import find_scale, tell_scale
from threedfs.io.textured_meshes import read_textured_obj
from threedfs.io.volumes import read_silhouettes
from threedfs.object.stand import height_on
from threedfs.read_ahead import map_ahead
from threedfs.report.camera_path import draw_path, unfilmed_angle
from threedfs.report.findings import Facts, Finding, doubt_truth, judge, sum_up
from threedfs.report.page import KeyframePictures, Report, write_page
from threedfs.report.pictures import color_depth, color_normals, embed_image, outline_mask
from threedfs.report.viewer import embed_viewer
from threedfs.run_end.known import MASK_METHODS, Known, choose, find_masks, find_method, gather
from threedfs.run_end.logs import read_actions
from threedfs.run_end.summary import Summary, write_summary
from threedfs.texture.photograph import photograph_texture, photograph_vertices
from threedfs.texture.textured import TexturedMesh
from threedfs.types import Mesh

_LONGEST, _STILL = 420, 900
"""Pixels along the longer side of a keyframe's pictures, and of the mesh's."""
_SMALL = 240
"""The same of the picture on the page over all sequences."""
_PICTURES = 5_000_000
"""Characters that the pictures of all keyframes may take in the page: many keyframes have smaller ones."""
_KINDS = 4
"""Pictures of a keyframe."""
_AGREED = 0.5
"""Share of the photographs at a vertex that must agree on it."""
_FILES = {
    "the object with photographs on it, upright: open it in any viewer": "mesh.glb",
    "the object in full detail": "mesh.ply",
    "the object with photographs on it, for other programs": "textured/mesh.obj",
}


@dataclass(frozen=True)
class Context:
    """What the page tells that does not lie in the folder.

    Attributes
    ----------
    store : Path
    metrics : sequence of Metric
        Of the sequence.
    failures : sequence of str
        Sentences of its jobs that failed.
    methods : tuple of str, optional
        Those of the run; what others left in the folder is not shown. All, if not given.
    stale : collection of str
        Files and folders that the run should have made anew and did not.
    scored_only : bool
        Whether nothing but scoring failed, so that mesh and masks are those of the run.
    settings : mapping of str to str
        Those that differ from the defaults.
    versions : mapping of str to str
    threads : int
        Draw the pictures of keyframes; their number changes no page.
    """

    store: Path
    metrics: Sequence[Metric] = ()
    failures: Sequence[str] = ()
    methods: tuple[str, ...] | None = None
    stale: Collection[str] = ()
    scored_only: bool = False
    settings: Mapping[str, str] = field(default_factory=dict)
    versions: Mapping[str, str] = field(default_factory=dict)
    threads: int = 1


def write_report(folder: Path, context: Context) -> Path:
    """Write report.html into the folder of a sequence's results, and its summary; what is not there yet is left out.

    After a failure mesh and masks are left out too, unless only scoring failed: they may be of an earlier run.
    """
    known = gather(folder, context.methods, context.stale)
    failed = bool(context.failures) and not context.scored_only
    findings = () if failed else tuple(_judge(folder, known))
    shown = None if failed else _find_mesh(folder, known)
    report = Report(
        folder.name,
        failures=tuple(context.failures),
        findings=() if failed else (*_doubt(context.metrics), *findings),
        viewer=_embed(shown, known),
        path=draw_path(known.poses.views, known.keyframes, known.place) if known.place and known.poses else "",
        keyframes=tuple(_picture_keyframes(folder, known, context, with_masks=not failed)),
        size="" if failed else _tell_size(folder, known),
        files={} if failed else _find_files(folder, context.methods),
        left_out=known.poses.unposed if known.poses else (),
        scores=_tabulate(context.metrics),
        costs=tuple(_find_costs(folder, context.store)),
        settings=context.settings,
        versions=context.versions,
    )
    with atomic(folder / "report.html") as temporary:
        temporary.write_text(write_page(report), encoding="utf-8")
    summary = Summary(
        context.methods or (),
        (known.method or "") if shown else "",
        sum_up(list(findings)) if findings else "",
        all(finding.good for finding in findings) if findings else None,
        tuple(context.failures),
        embed_image(shown.still, _SMALL, 75) if shown else _first_picture(report),
    )
    write_summary(folder, summary)
    return folder / "report.html"


def _first_picture(report: Report) -> str:
    """Return the smallest stand-in for a mesh: the first picture of the first keyframe, empty without any."""
    return next((picture for each in report.keyframes for picture in each.pictures.values()), "")


def write_reports(folders: Sequence[Path], contexts: Callable[[str], Context], note: Callable[[str], object]) -> None:
    """Write the reports of sequences; one that cannot be made ends no run, and has the failures alone.

    Parameters
    ----------
    folders : sequence of Path
        Of the sequences' results.
    contexts : callable
        Gives what else is known of a sequence, by its name.
    note : callable
        Takes a sentence for a report that could not be made.
    """
    for folder in folders:
        context = contexts(folder.name)
        try:
            write_report(folder, context)
        except Exception as fault:
            note(f"the report of {folder.name} was not made: {type(fault).__name__}: {fault}")
            bare = Report(folder.name, failures=tuple(context.failures), settings=context.settings)
            with atomic(folder / "report.html") as temporary:
                temporary.write_text(write_page(bare), encoding="utf-8")
            failed = "its report could not be made"
            write_summary(folder, Summary(context.methods or (), verdict=failed, failures=tuple(context.failures)))


def _doubt(metrics: Sequence[Metric]) -> list[Finding]:
    """Return what makes the truth of a sequence doubtful, each sentence once for all methods."""
    figures: dict[str, dict[str, float]] = defaultdict(dict)
    for metric in metrics:
        if not metric.keyframe:
            figures[metric.method][metric.name] = metric.value
    return doubt_truth(list(dict.fromkeys(sentence for own in figures.values() for sentence in find_doubts(own))))


def find_out(folder: Path, methods: Collection[str] | None = None) -> list[Finding]:
    """Return what is to be known of a sequence's results before trusting them; nothing without a mesh."""
    return _judge(folder, gather(folder, methods))


def _judge(folder: Path, known: Known) -> list[Finding]:
    if known.place is None or known.poses is None or known.method is None:
        return []
    path = folder / "11_object" / known.method / "mesh.ply"
    sound = {figure.name: figure.value for figure in soundness_figures(read_mesh(path))}
    agreed = read_vertex_property(path, "confirmed")
    return judge(
        Facts(
            posed=len(known.poses.views),
            frames=len(known.poses.views) + len(known.poses.unposed),
            quality=known.poses.quality,
            widest_gap=unfilmed_angle(known.poses.views, known.place),
            margin_used=known.place.figures.get("margin_used"),
            closed=bool(sound["mesh_closed"]),
            pieces=int(sound["mesh_pieces"]),
            genus=int(sound.get("mesh_genus", 0)),
            confirmed=None if agreed is None else float((agreed >= _AGREED).mean()),
        )
    )


@dataclass(frozen=True)
class _Shown:
    """The mesh on the page, and its picture (H, W, 3) uint8 from the first keyframe."""

    surface: TexturedMesh | Mesh
    still: np.ndarray


def _find_mesh(folder: Path, known: Known) -> _Shown | None:
    if known.place is None or known.method is None or not known.keyframes:
        return None
    own = folder / "11_object" / known.method
    surface: TexturedMesh | Mesh
    if (own / "textured/mesh.obj").is_file():
        surface = textured = read_textured_obj(own / "textured/mesh.obj")
        photographer = photograph_texture(textured)
    else:
        mesh, colors = read_colored_mesh(own / "mesh.ply")
        surface = mesh
        plain = np.full((len(mesh.vertices), 3), 180.0)
        photographer = photograph_vertices(mesh, plain if colors is None else colors.astype(np.float64))
    image, seen = photographer.take(next(iter(known.keyframes.values())).view)
    return _Shown(surface, np.where(seen[..., None], image.clip(0, 255), 244).astype(np.uint8))


def _embed(shown: _Shown | None, known: Known) -> str:
    """Return the viewer of the mesh, empty where there is none."""
    if shown is None or known.place is None or known.poses is None:
        return ""
    return embed_viewer(shown.surface, known.place.plane, known.poses.views, embed_image(shown.still, _STILL))


def _picture_keyframes(folder: Path, known: Known, context: Context, with_masks: bool) -> Iterator[KeyframePictures]:
    crops = folder / "04_crops/crops.zarr.zip"
    if not crops.is_file() or str(crops) in context.stale:
        return
    store, most = read_crops(crops), _PICTURES / (_KINDS * max(1, len(known.keyframes)))
    with_depth = str(folder / "06_depth") not in context.stale
    drawn = (folder / "11_object" / name / "silhouettes.zarr.zip" for name in choose(MASK_METHODS, context.methods))
    masks = next((read_silhouettes(path) for path in drawn if with_masks and path.is_file()), {})

    def picture(name: str) -> KeyframePictures:
        keyframe, image, depth = known.keyframes[name], store.image(name), folder / f"06_depth/{name}.zarr.zip"
        pictures = {"photograph": image}
        if name in masks and masks[name].shape == image.shape[:2]:
            pictures = {"mask": outline_mask(image, masks[name])} | pictures
        if with_depth and depth.is_file():
            seen = read_depth_map(depth).depth
            pictures["depth"] = color_depth(seen, keyframe)
            pictures["normals"] = color_normals(normals_from_depth(keyframe.view.camera, seen))
        return KeyframePictures(name, {kind: embed_image(each, _LONGEST, 75, most) for kind, each in pictures.items()})

    yield from map_ahead(picture, known.keyframes, threads=context.threads)


def _tell_size(folder: Path, known: Known) -> str:
    scale = find_scale(folder)
    if scale is None or known.place is None or known.method is None:
        return ""
    height = height_on(read_mesh(folder / "11_object" / known.method / "mesh.ply"), known.place.plane)
    unit = 1000 * scale.metres_per_unit
    return f"{unit * height:.1f} mm tall; a scene unit is {unit:.2f} mm. Found by a {tell_scale(scale)}."


def _find_files(folder: Path, methods: Collection[str] | None) -> dict[str, str]:
    """Return what the run made, what it is by its place below the folder."""
    method, masks = find_method(folder, methods), find_masks(folder, methods)
    places = {what: folder / "11_object" / method / name for what, name in _FILES.items()} if method else {}
    if masks:
        places["a mask of the object in every keyframe"] = masks
    return {what: path.relative_to(folder).as_posix() for what, path in places.items() if path.exists()}


def _tabulate(metrics: Sequence[Metric]) -> dict[str, dict[str, str]]:
    scores: dict[str, dict[str, str]] = defaultdict(dict)
    for metric in metrics:
        if not metric.keyframe and not metric.name.startswith(("seconds", "peak_memory", "bytes")):
            unit = "" if metric.unit == "1" else f" {metric.unit}"
            scores[metric.method][metric.name] = f"{metric.value:.4g}{unit}"
    return dict(scores)


def _find_costs(folder: Path, store: Path) -> Iterator[tuple[str, float, float]]:
    figures = {figure.name: figure.value for figure in cost_figures(read_actions(folder, store))}
    stages = [name.removeprefix("seconds_") for name in figures if name.startswith("seconds_")]
    for stage in sorted(stages, key=lambda stage: -figures[f"seconds_{stage}"]):
        yield stage, figures[f"seconds_{stage}"], figures[f"peak_memory_{stage}"]
