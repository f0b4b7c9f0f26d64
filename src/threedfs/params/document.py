"""Write config/config.yaml, its schema and its documentation from the declared parameters.

Run as ``python -m threedfs.params.document`` in the project's folder (``make config``).
"""

from __future__ import annotations

import json
import textwrap
from dataclasses import Field, fields
from pathlib import Path
from typing import Any

from threedfs.params.configuration import configuration_schema
from threedfs.params.schema import declared_stages, default_settings, stage_schema

GENERAL = """\
# Every parameter with its default; config/README.md tells what each means. Made by `make config`.
# Change values in a file of your own, given with --configfile: what it names takes the place of what is here.

# Name of the set of sequences, a column of results/metrics.csv.
dataset: sample

# One video or folder of photos to reconstruct instead of the sequences below: --config video=path/to/my.mp4
video: null

# Sequences by name; without any, the sample that ships with the project. Relative paths count from where you run.
#   mug:
#     source: videos/mug.mp4        # a video or a folder of photos
#     dataset: kitchen              # in place of the one above
#     cameras: null                 # given cameras, instead of structure from motion
#     intrinsics: null              # [fx, fy, cx, cy], for given cameras that are poses alone
#     calibration: null             # photos or a video of a checkerboard
#     scale: null                   # {tag: 40mm}, {board: {corners: [9, 6], square: 25mm}} or {height: 95mm}
#     object: true                  # false: no object is looked for, only the depth experiment runs
#     settings: {depth: {iterations: 12}}  # its own values of the parameters below
#     truth: {masks: null, cameras: null, mesh: null, depth: null, depth_scale: 1000, depth_camera: null}
#     keyframes_at_truth: false     # in place of the one below
#   dragon:
#     rendered: dragon              # a take of the synthetic data set, with its truth
sequences: {}

# A truth changes no result; with true it does: frames with a true mask are keyframes, and all methods are scored there.
keyframes_at_truth: false

# Go on without the sequences whose source is absent; they are named at the start.
skip_absent: false

# How the object is made: fused_sdf, deformed_sdf, volumetric_gc, gc_2d, spectral_matting, gc_2d3d_pixel,
# gc_2d3d_voxel, gc_select, sdf_2d3d_voxel, surface, tsdf, soft_maximum, hard_maximum, poisson.
methods: [surface, gc_2d3d_pixel, sdf_2d3d_voxel]

# The joint segmentation with other settings, beside the configured one: tables tell what each changes.
#   no_table: {segment: {table: false}}
variants: {}

# Of every random choice.
seed: 0

# Finished work, shared by all sequences; may be outside of results/, and shared by several checkouts.
store: results/.store

# Another store, which is only read: what it has is copied from there instead of made.
store_fallback: null
"""

_INTRODUCTION = """\
# Configuration

`config.yaml` holds every parameter with its default. Give your own values in a file of your own:

    snakemake --cores 2 --configfile my.yaml

Values in your file replace the defaults; everything else keeps its default. `presets/paper.yaml` has the constants of
the paper, `presets/quick.yaml` makes everything small, `presets/draft.yaml` and `presets/fine.yaml` are the qualities
of `threedfs run`. Several files can be given together; where they differ, the last one counts:
`--configfile my.yaml config/presets/paper.yaml`. Sections are merged key by key, so a second file adds
its sequences to those of the first; lists and single values are replaced. `benchmark.yaml` is the whole benchmark,
`printed.yaml` the paper's table with its constants, `matting.yaml` four of its rows with the matting that it tried,
`suspects.yaml` one of its takes with one thing changed at a time that the paper leaves open, `contours.yaml` the
benchmark's sequences by gradients and by learned contours.
One video needs no file: `snakemake --cores 2 --config video=path/to/my.mp4 dataset=mine`. Other values can be given in
the same way (`seed`, `store`, `store_fallback`, `'methods=[fused_sdf, tsdf]'`, `'depth={iterations: 5}'`); not with a
dot, which Snakemake refuses.
`datasets/` has files of sequences: the data sets that the project is measured on, and the layouts of published ones.

An unknown key, a wrong type or a value out of range stops the run before it starts, with a sentence that
says what to change.

## Sequences

{keys}
Paths count from the folder in which `snakemake` runs. A sequence's name is a folder's name: letters, digits, dots,
dashes, underscores.

Masks of your own to score against are PNG of the size of the video or the photos, white on black, called by the
frame's number from 0 (`120.png`) or like the photo; a few are enough. Scores: `results/tables/iou.md`.

    dataset: mine
    sequences:
      mug: {source: mug.mp4, truth: {masks: mug_masks}}

They may be added after a run: then only scores are computed. At a keyframe, its mask is scored; at another frame that
was worked on, the mesh as that frame's camera sees it. A long video is worked on at every n-th frame, and
`threedfs export results/mug scene --scene` writes those: a mask of a frame between them is left out, which the tables
tell, unless `truth.cameras` has its camera or `keyframes_at_truth` is set. A mask may be black all over, where the
object is out of view; not all of them may.

A file or folder that is missing or cannot be used stops the run before it starts; a dry run, `-n`, looks at all of them
too. With `--keep-going` its sequence fails at once and the others are finished, as with whatever else may go wrong in a
sequence; the tables name it with the reason, and the exit status is not 0.

## Parameters

Symbol and equation are those of the paper, equations counted in the order of its source.
"""

_KEYS = {
    "dataset": "name of the set, a column of `results/metrics.csv`; tables and plots are made for each set",
    "video": "one video or folder of photos; the sequence gets the file's name; given beside `sequences` it takes "
    "their place",
    "sequences.<name>.source": "a video (mp4, mov) or a folder of photos (jpg, png, heic, tif, bmp, webp) of one "
    "camera, zoom and orientation; those of another size are left out",
    "sequences.<name>.dataset": "its own set, in place of `dataset`: one file may hold several sets",
    "sequences.<name>.cameras": "given cameras: a COLMAP model folder, `transforms.json`, `cameras.json` with "
    "`cam_to_world`, a folder of CONTOUR projection matrices or of `NAME.pose.txt` (7-Scenes, 3DMatch), or a pose file "
    "of RGB-D Scenes v2; null: structure from motion",
    "sequences.<name>.intrinsics": "[fx, fy, cx, cy] in pixels of the source, the first pixel's centre at (0, 0), for "
    "given and true cameras that are poses alone: RGB-D Scenes v2, and `NAME.pose.txt`, where it takes the place of "
    "`camera-intrinsics.txt`",
    "sequences.<name>.calibration": "photos or a video of a checkerboard; null: the camera calibrates itself",
    "sequences.<name>.scale": "what tells the size: `{tag: 40mm}`, the side of the black square of an ArUco "
    "or AprilTag in the scene; `{board: {corners: [9, 6], square: 25mm}}`, the inner corners and the side of a "
    "square of a checkerboard; or `{height: 95mm}`, the object's own; exports are then in metres or millimetres",
    "sequences.<name>.rendered": "instead of all of the above and below: a take of the synthetic data set Tabletop-12 "
    "(config/datasets/tabletop12.yaml), filmed by the run with all its truth",
    "sequences.<name>.true_cameras": "of a rendered sequence: take its true cameras as given, instead of structure "
    "from motion",
    "sequences.<name>.object": "false: no object is looked for, the sequence only takes part in the depth experiment "
    "(default true)",
    "sequences.<name>.truth.masks": "folder of masks named like the frames (white: object), to measure against; "
    "results do not depend on them, nor on what else is given as truth",
    "sequences.<name>.truth.cameras": "reference cameras, to measure against",
    "sequences.<name>.truth.mesh": "reference mesh, in the frame of the reference cameras, which it needs",
    "sequences.<name>.truth.depth": "folder of true depth images, `NAME.depth.png` or `NNNNN-depth.png`; "
    "needs `truth.cameras`",
    "sequences.<name>.truth.depth_scale": "their units per unit of the true cameras (default 1000: millimetres and "
    "metres)",
    "sequences.<name>.truth.depth_camera": "for depth images that are not registered to the colour images: "
    "{intrinsics: [fx, fy, cx, cy], offset: [x, y, z]} of the depth camera, its place in the colour camera's axes in "
    "units of the true cameras; null: both images are of one camera",
    "sequences.<name>.settings": "its own values of parameters, by section, in place of those of the whole run: "
    "`{depth: {photometric_weight: 10}}`",
    "keyframes_at_truth": "true: frames with a true mask are working frames and keyframes, so that the masks of every "
    "method are scored at all of them, which makes results depend on the truth; for benchmarks. A sequence's own "
    "`keyframes_at_truth` goes before it (default false)",
    "skip_absent": "go on without the sequences whose source is absent; they are named at the start",
    "methods": "how the object is made, each with masks and figures of its own, and a mesh but for three: `fused_sdf` "
    "(the views weighed by trust), `deformed_sdf` (its zero level moved onto surface points), `volumetric_gc` (voxels "
    "cut by colour alone), `gc_2d` (images cut by colour, only masks), `spectral_matting` (each image split into soft "
    "components, only masks), `gc_2d3d_pixel` (images and voxels cut in one, only masks), "
    "`gc_2d3d_voxel` (its voxels), `gc_select` (their largest piece), `sdf_2d3d_voxel` (the field inside "
    "that piece), `surface` (confirmed depth and the hull of the masks), `tsdf` (KinectFusion's weighted average), "
    "`soft_maximum` (Eq. 15 as printed), `hard_maximum` (Eq. 13), `poisson` (the surface points alone)",
    "variants.<name>": "the methods of the joint segmentation once more with settings of its own, "
    "`{segment: {table: false}, cut_object: {...}}`; results are called `METHOD@NAME`, and a table tells how the IoU "
    "changes. `ablation.yaml` has one for every term and option",
    "seed": "of every random choice",
    "store": "folder of finished work, and of the kernels compiled for it",
    "store_fallback": "another store, which is only read: finished work is copied from there before it is done "
    "([sharing](../docs/store.md))",
}


def make_defaults() -> str:
    """Return the text of config.yaml."""
    parts = [GENERAL]
    for stage, declared in declared_stages().items():
        lines = [f"\n{stage}:"]
        for field in fields(declared):
            unit = f" [{field.metadata['unit']}]" if field.metadata["unit"] else ""
            lines += [
                f"  # {line}" for line in textwrap.wrap(field.metadata["meaning"] + unit, 110, break_long_words=False)
            ]
            lines.append(f"  {field.name}: {_yaml(default_settings(declared)[field.name])}")
        parts.append("\n".join(lines) + "\n")
    return "".join(parts)


def make_documentation() -> str:
    """Return the text of config/README.md."""
    keys = [f"| `{key}` | {meaning} |" for key, meaning in _KEYS.items()]
    parts = [_INTRODUCTION.replace("{keys}", "\n".join(["| key | meaning |", "|---|---|", *keys, ""]))]
    for stage, declared in declared_stages().items():
        parts.append(f"\n### {stage}\n\n{(declared.__doc__ or '').strip().splitlines()[0]}\n\n")
        parts.append("| key | default | meaning | unit | range | symbol | equation |\n|---|---|---|---|---|---|---|\n")
        parts += [_row(field, stage_schema(declared)["properties"][field.name]) for field in fields(declared)]
    return "".join(parts)


def make_schema() -> str:
    """Return the text of workflow/schemas/config.schema.yaml; JSON, which is YAML too."""
    return json.dumps(configuration_schema(), indent=2) + "\n"


FILES = {
    "config/config.yaml": make_defaults,
    "config/README.md": make_documentation,
    "workflow/schemas/config.schema.yaml": make_schema,
}


def main() -> None:
    """Write the three files below the working directory."""
    for name, make in FILES.items():
        Path(name).write_text(make(), encoding="utf-8")


def _row(field: Field, schema: dict[str, Any]) -> str:
    note = field.metadata
    cells = [
        f"`{field.name}`",
        f"`{_yaml(list(field.default) if isinstance(field.default, tuple) else field.default)}`",
        note["meaning"],
        note["unit"],
        _range(schema.get("items", schema)),
        note["symbol"],
        note["equation"],
    ]
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |\n"


def _range(schema: dict[str, Any]) -> str:
    if "enum" in schema:
        return ", ".join(f"`{_yaml(choice)}`" for choice in schema["enum"])
    limits = [f">= {schema['minimum']}"] if "minimum" in schema else []
    limits += [f"> {schema['exclusiveMinimum']}"] if "exclusiveMinimum" in schema else []
    limits += [f"<= {schema['maximum']}"] if "maximum" in schema else []
    return ", ".join(limits)


def _yaml(value: Any) -> str:
    """Write a plain value as YAML; words without quotes."""
    if isinstance(value, list):
        return "[" + ", ".join(_yaml(item) for item in value) + "]"
    if isinstance(value, float):
        # YAML 1.1 reads 1e-06 as text unless the mantissa has a point
        text = repr(value)
        return text.replace("e", ".0e") if "e" in text and "." not in text else text
    return value if isinstance(value, str) and value.isidentifier() else json.dumps(value)


if __name__ == "__main__":
    main()
