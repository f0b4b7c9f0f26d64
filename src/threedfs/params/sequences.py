"""The sequences that the configuration lists: their files, and which of them are absent or missing."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Collection, Mapping, Sequence
from pathlib import Path
from typing import Any, TextIO

from threedfs.errors import UserError
from threedfs.params.configuration import (
    MESH_METHODS,
    SEQUENCE_NAME,
    check_configuration,
    configuration_schema,
    explain_name,
)
from threedfs.params.rendered import bring_render, find_films
from threedfs.params.sizes import read_scale_entry

SEQUENCE_FILES = ("source", "cameras", "calibration", "truth_masks", "truth_cameras", "truth_mesh", "truth_depth")
"""What a sequence's entry names: files and folders that must be there."""
_FILES = (*SEQUENCE_FILES, "keyframe_masks")
"""With those of them that a sequence may have in two roles."""

RUN_FILES = {"README.md", "benchmarks", "index.html", "logs", "metrics.csv", "plots", "tables"}

_REPLACED = re.compile(r"<[a-z][a-z0-9_]*>|\{\s*[.\w]+\s*(?:,[^{}]*(?:\{\d+(?:,\d+)?\}[^{}]*)*)?\}")
"""What Snakemake replaces in every path, and cannot be told to leave: path variables and wildcards."""
_DEPTH_SCALE = 1000.0  # levels of a true depth image in a metre: millimetres


def load_sequences(
    config: Mapping[str, Any], home: Path, notes: TextIO | None = None
) -> tuple[dict[str, dict[str, Any]], dict[str, str]]:
    """Check the configuration and return its sequences, as `list_sequences` and `set_aside_missing` do.

    Each sequence says too whether it takes part in the depth experiment.

    Parameters
    ----------
    config, home
        As `list_sequences` takes them.
    notes : text stream, optional
        Gets a line for each sequence that is skipped.

    Raises
    ------
    UserError
        If also the depth experiment names a sequence that cannot take part, nothing is to be done with one, a path
        holds what Snakemake replaces, or a truth lacks the cameras that say where it lies.
    """
    check_configuration(config, configuration_schema())
    sequences = list_sequences(config, home, lambda sentence: notes and notes.write(f"threedfs: {sentence}\n"))
    tried, named = config["depth_experiment"]["sequences"], {*sequences, *(config["sequences"] or {})}
    _check_known("depth_experiment.sequences", tried, named)
    _check_known("evaluate.cylinder_sequences", config["evaluate"]["cylinder_sequences"], named)
    _check_tried(sequences, tried)
    _check_paths(sequences)
    _check_truth(sequences)
    _check_scales(sequences, config["methods"])
    return set_aside_missing({name: {**entry, "depth_experiment": name in tried} for name, entry in sequences.items()})


def list_sequences(
    config: Mapping[str, Any], home: Path, note: Callable[[str], Any] = lambda sentence: None
) -> dict[str, dict[str, Any]]:
    """Return the sequences to work on, by name.

    Without `video` or `sequences` that is the sample which ships with the project. Relative paths count from the
    working directory, the sample's from `home`.

    Parameters
    ----------
    config : mapping
    home : Path
        Folder of the project.
    note : callable
        Takes a sentence for each sequence that is skipped because its source is absent (`skip_absent`).

    Returns
    -------
    dict of str to dict
        `SEQUENCE_FILES`: paths or None; keyframe_masks: the true masks, if their frames are to be keyframes
        (`keyframes_at_truth`), or None; dataset: str; intrinsics: list of float or None; object: bool; scale: dict as
        of `read_scale_entry`, or None; depth_scale: float; depth_camera: dict or None; settings: dict of sections of
        the configuration, its own values; rendered: the take that is filmed for the sequence, or None. The paths of a
        rendered sequence are results of the run.

    Raises
    ------
    UserError
        If a name cannot name a folder, the one video is not there, it is not clear where the images come from, or all
        sequences are absent.
    """
    given: dict[str, Any] = dict(config["sequences"] or {})
    if config["video"]:
        if not os.path.exists(config["video"]):
            raise UserError(f"video: expected a video file or a folder of photos, found no {config['video']}.")
        name = Path(config["video"]).stem
        if not re.match(SEQUENCE_NAME, name):
            raise UserError(explain_name(name, f"the file {config['video']}; rename it, or list it under sequences"))
        given = {name: {"source": config["video"]}}
    taken = sorted(RUN_FILES & set(given))
    if taken:
        raise UserError(
            f"sequences: expected other names than {', '.join(sorted(RUN_FILES))}, which the run itself writes in "
            f"results, found {taken[0]}; rename it."
        )
    films = find_films(given)
    sequences = {name: _flatten(bring_render(name, entry, films.get(name, name))) for name, entry in given.items()}
    sequences = sequences or {"sample": _sample(home)}
    if config["skip_absent"]:
        sequences = _skip_absent(sequences, note)
    return {name: _fill_in(name, entry, config) for name, entry in sequences.items()}


def _fill_in(name: str, entry: Mapping[str, Any], config: Mapping[str, Any]) -> dict[str, Any]:
    """Return a sequence's entry with what holds for the whole run where it does not speak for itself."""
    own = entry["keyframes_at_truth"]
    at_truth = config["keyframes_at_truth"] if own is None else own
    return {
        **entry,
        "dataset": entry["dataset"] or config["dataset"],
        "keyframe_masks": entry["truth_masks"] if at_truth else None,
        "scale": read_scale_entry(entry["scale"], f"sequences.{name}.scale"),
    }


def set_aside_missing(sequences: Mapping[str, Mapping[str, Any]]) -> tuple[dict[str, dict[str, Any]], dict[str, str]]:
    """Find the sequences of which a file or folder is missing.

    Parameters
    ----------
    sequences : mapping
        From `list_sequences`.

    Returns
    -------
    sequences : dict
        The same; where one path leads nowhere, all paths are None.
    missing : dict of str to str
        For each of those a sentence about the first such path.
    """
    missing: dict[str, str] = {}
    for name, entry in sequences.items():
        for key in SEQUENCE_FILES:
            if entry["rendered"] is None and entry[key] is not None and not os.path.exists(entry[key]):
                where = f"sequences.{name}.{key.replace('truth_', 'truth.')}"
                missing.setdefault(name, f"{where}: expected a file or folder, found no {entry[key]} in {os.getcwd()}.")
    emptied = {name: {**sequences[name], **dict.fromkeys(_FILES)} for name in missing}
    return {name: dict(entry) for name, entry in {**sequences, **emptied}.items()}, missing


def _check_known(key: str, names: Sequence[str], known: Collection[str]) -> None:
    unknown = [name for name in names if name not in known]
    if unknown:
        raise UserError(f"{key}: expected names of sequences, got {', '.join(unknown)}, which is none of them.")


def _check_tried(sequences: Mapping[str, dict[str, Any]], tried: list[str]) -> None:
    for name, entry in sequences.items():
        missing = [key for key in ("cameras", "truth_cameras", "truth_depth") if entry[key] is None]
        if name in tried and missing:
            raise UserError(
                f"depth_experiment.sequences: expected given cameras and true depth of {name}, found no "
                f"{' and no '.join(missing).replace('truth_', 'truth.')}; give them under sequences.{name}."
            )
        if name not in tried and not entry["object"]:
            raise UserError(
                f"sequences.{name}: expected its name in depth_experiment.sequences, as object: false leaves nothing "
                "else to do, found it missing; add it there."
            )


def _check_paths(sequences: Mapping[str, dict[str, Any]]) -> None:
    for name, entry in sequences.items():
        for key in SEQUENCE_FILES:
            found = _REPLACED.search(entry[key] or "")
            if found:
                raise UserError(
                    f"sequences.{name}.{key.replace('truth_', 'truth.')}: expected a path without {found[0]}, which "
                    f"Snakemake would replace by something else, got {entry[key]}; rename it."
                )


def _check_truth(sequences: Mapping[str, dict[str, Any]]) -> None:
    for name, entry in sequences.items():
        for what in ("mesh", "depth"):
            if entry[f"truth_{what}"] is not None and entry["truth_cameras"] is None:
                raise UserError(
                    f"sequences.{name}.truth.{what}: expected truth.cameras beside it, found none; they tell where "
                    f"{entry[f'truth_{what}']} lies."
                )


def _check_scales(sequences: Mapping[str, dict[str, Any]], methods: Sequence[str]) -> None:
    for name, entry in sequences.items():
        height = entry["scale"] is not None and entry["scale"]["source"] == "height"
        if height and (not entry["object"] or not set(methods) & set(MESH_METHODS)):
            raise UserError(
                f"sequences.{name}.scale.height: expected a method with a mesh, whose height that is, found none; add "
                "surface to methods, or give tag or board."
            )


def _skip_absent(sequences: Mapping[str, dict[str, Any]], note: Callable[[str], Any]) -> dict[str, dict[str, Any]]:
    present = {name: entry for name, entry in sequences.items() if entry["rendered"] or os.path.exists(entry["source"])}
    if not present:
        raise UserError(
            f"sequences: expected at least one whose source is there, found none of the {len(sequences)} in "
            f"{os.getcwd()}, e.g. no {next(iter(sequences.values()))['source']}; get the data, or correct the paths."
        )
    for name in sequences:
        if name not in present:
            note(f"sequence {name} is skipped: its source {sequences[name]['source']} is not in {os.getcwd()}.")
    return present


def _sample(home: Path) -> dict[str, Any]:
    folder = home / "resources" / "sample"
    if folder.is_relative_to(os.getcwd()):
        folder = folder.relative_to(os.getcwd())
    truth = {"masks": "masks", "cameras": "cameras.json", "mesh": "mesh.ply"}
    return _flatten(
        {
            "source": str(folder / "video.mp4"),
            "truth": {name: str(folder / file) for name, file in truth.items()},
            "keyframes_at_truth": True,  # its figures are over all of its masks, whatever is configured
        }
    )


def _flatten(entry: Mapping[str, Any]) -> dict[str, Any]:
    truth = {f"truth_{key}": value for key, value in (entry.get("truth") or {}).items()}
    return {key: {**entry, **truth}.get(key) for key in SEQUENCE_FILES} | {
        "dataset": entry.get("dataset"),
        "keyframes_at_truth": entry.get("keyframes_at_truth"),
        "rendered": entry.get("rendered"),
        "intrinsics": entry.get("intrinsics"),
        "object": entry.get("object", True),
        "scale": entry.get("scale"),
        "depth_scale": truth.get("truth_depth_scale", _DEPTH_SCALE),
        "depth_camera": truth.get("truth_depth_camera"),
        "settings": entry.get("settings", {}),
    }
