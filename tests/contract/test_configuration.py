"""Contract: declared parameters, defaults, schema, documentation and presets are in step."""

from __future__ import annotations

import ast
import importlib
import inspect
import io
from dataclasses import fields
from pathlib import Path
from types import ModuleType

import pytest
import yaml

from threedfs.cli.main import METHOD_LINES
from threedfs.errors import UserError
from threedfs.evaluate.paper_table import SEQUENCES
from threedfs.params.configuration import (
    JOINT_METHODS,
    MESH_METHODS,
    METHODS,
    check_configuration,
    configuration_schema,
)
from threedfs.params.document import FILES
from threedfs.params.schema import STAGES, declared_stages, default_settings, make_params
from threedfs.params.sequences import list_sequences, load_sequences, set_aside_missing
from threedfs.run_end.known import MASK_METHODS

ROOT = Path(__file__).resolve().parents[2]
STAGE_PARAMETERS = [(s, f.name) for s, declared in declared_stages().items() for f in fields(declared)]


@pytest.fixture(scope="module")
def defaults() -> dict:
    """The configuration as it ships."""
    return yaml.safe_load((ROOT / "config/config.yaml").read_text())


def merged(defaults: dict, other: dict) -> dict:
    """Lay a configuration over the defaults, as Snakemake does."""
    sections = {key: {**value, **other.get(key, {})} for key, value in defaults.items() if isinstance(value, dict)}
    return {**defaults, **other, **sections}


def test_every_method_is_known_to_those_who_look_for_its_results():
    """One with a mesh is in MESH_METHODS, which the report, the size and exports go by; the others have masks alone."""
    assert set(MASK_METHODS) == set(METHODS) == set(METHOD_LINES)
    assert set(METHODS) - set(MESH_METHODS) == {"gc_2d", "gc_2d3d_pixel", "spectral_matting"}
    assert set(JOINT_METHODS) <= set(METHODS)


@pytest.mark.parametrize("name", FILES)
def test_generated_file_is_in_step_with_the_parameters(name):
    assert (ROOT / name).read_text() == FILES[name](), "run make config"


def test_every_module_of_parameters_is_a_stage():
    modules = {path.stem for path in (ROOT / "src/threedfs/params").glob("*.py")}
    shared = {
        "__init__",
        "field",
        "schema",
        "configuration",
        "document",
        "fusion",
        "component",
        "rendered",
        "changes",
        "command_line",
        "rules",
        "sequences",
        "smoothing",
        "sizes",
    }
    assert modules - shared == set(declared_stages()) <= set(STAGES)


def test_defaults_are_valid_and_survive_the_round_trip(defaults):
    check_configuration(defaults, configuration_schema())
    for stage, declared in declared_stages().items():
        assert make_params(declared, defaults[stage]) == declared()
        assert make_params(declared, default_settings(declared)) == declared()


@pytest.mark.parametrize("stage", declared_stages())
def test_every_parameter_is_used_by_its_stage(stage):
    declared = declared_stages()[stage]
    read = parameters_read(importlib.import_module(f"threedfs.stages.{stage}"), declared)
    texts = [(ROOT / f"src/threedfs/params/{name}.py").read_text() for name in ("configuration", "sequences")]
    names = {field.name for field in fields(declared)}
    before_the_run = {name for name in names if any(f'["{stage}"]["{name}"]' in text for text in texts)}
    assert names <= read | before_the_run


def parameters_read(module: ModuleType, declared: type) -> set[str]:
    """Return the parameters that a stage reads itself, and those that rules and the settings of depth take."""
    tree = ast.parse(inspect.getsource(module))
    attributes = (node for node in ast.walk(tree) if isinstance(node, ast.Attribute))
    read = {node.attr for node in attributes if isinstance(node.value, ast.Name) and node.value.id == "params"}
    for call in (node for node in ast.walk(tree) if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)):
        if call.func.id == "make_rule":
            read |= set(inspect.signature(getattr(module, call.args[0].id)).parameters)
        elif call.func.id in ("matching_settings", "solver_settings") and ast.unparse(call.args[0]) == "params":
            read |= set(getattr(module, call.func.id)(declared()))
    return read


@pytest.mark.parametrize(("stage", "name"), STAGE_PARAMETERS)
def test_every_parameter_says_what_it_means(stage, name):
    metadata = declared_stages()[stage].__dataclass_fields__[name].metadata
    assert len(metadata["meaning"]) > 8


@pytest.mark.parametrize("path", sorted((ROOT / "config").glob("*/*.yaml")), ids=lambda path: path.name)
def test_presets_and_data_sets_are_valid(defaults, path):
    check_configuration(merged(defaults, yaml.safe_load(path.read_text())), configuration_schema())


def test_benchmark_holds_every_object_of_the_paper_every_real_sequence():
    benchmark = yaml.safe_load((ROOT / "config/benchmark.yaml").read_text())
    real = yaml.safe_load((ROOT / "config/datasets/real.yaml").read_text())
    sequences = benchmark["sequences"]
    assert [entry["rendered"] for entry in sequences.values() if entry.get("rendered")] == [*SEQUENCES, *SEQUENCES]
    assert all(sequences[name] == {"rendered": name} for name in SEQUENCES)
    for name, entry in real["sequences"].items():
        assert sequences[name] == {**entry, "dataset": real["dataset"]}
    assert benchmark["evaluate"] == real["evaluate"]
    assert set(benchmark["methods"]) <= set(METHODS)
    assert set(benchmark["depth_experiment"]["sequences"]) <= set(sequences)


def test_the_printed_table_is_of_the_paper_and_of_the_benchmarks_images(defaults):
    printed = yaml.safe_load((ROOT / "config/printed.yaml").read_text())
    benchmark = yaml.safe_load((ROOT / "config/benchmark.yaml").read_text())
    check_configuration(merged(defaults, printed), configuration_schema())
    assert printed["sequences"] == {name: {"rendered": name} for name in SEQUENCES}
    assert all(printed[key] == benchmark[key] for key in ("frames", "keyframes_at_truth", "render", "keyframes"))
    assert len(printed["methods"]) == 8
    matting = yaml.safe_load((ROOT / "config/matting.yaml").read_text())
    check_configuration(merged(defaults, matting), configuration_schema())
    assert matting["methods"] == [*printed["methods"], "spectral_matting"]
    assert len(matting["sequences"]) == 4 and matting["sequences"].items() < printed["sequences"].items()
    assert {**matting, "methods": 0, "sequences": 0} == {**printed, "methods": 0, "sequences": 0}


def test_contours_are_compared_on_the_sequences_of_the_benchmark(defaults):
    contours = yaml.safe_load((ROOT / "config/contours.yaml").read_text())
    benchmark = yaml.safe_load((ROOT / "config/benchmark.yaml").read_text())
    check_configuration(merged(defaults, contours), configuration_schema())
    assert all(contours[key] == benchmark[key] for key in ("frames", "keyframes_at_truth", "render", "keyframes"))
    gradients = {name: entry for name, entry in contours["sequences"].items() if "settings" not in entry}
    assert gradients == {name: entry for name, entry in benchmark["sequences"].items() if entry.get("object", True)}
    settings = {"edges": {"method": "structured"}}
    assert settings["edges"]["method"] != defaults["edges"]["method"]
    for name, entry in gradients.items():
        dataset = f"{entry.get('dataset', contours['dataset'])}_learned"
        assert contours["sequences"][f"{name}_learned"] == {**entry, "dataset": dataset, "settings": settings}
    assert len(contours["sequences"]) == 2 * len(gradients)


def test_every_variant_of_the_ablation_changes_a_default(defaults):
    ablation = yaml.safe_load((ROOT / "config/ablation.yaml").read_text())
    check_configuration({**defaults, **ablation}, configuration_schema())
    for stages in ablation["variants"].values():
        assert all(value != defaults[stage][name] for stage, own in stages.items() for name, value in own.items())


def test_the_printed_variant_is_the_preset_of_the_paper(defaults):
    printed = yaml.safe_load((ROOT / "config/ablation.yaml").read_text())["variants"]["paper"]
    preset = yaml.safe_load((ROOT / "config/presets/paper.yaml").read_text())
    assert preset["spectral_matting"]["inner_level"] == preset["segment"]["inner_level"]
    levels = ("outer_level", "inner_level")  # shares of the clip distance, which is not the variant's
    for stage, own in printed.items():
        changed = {name: value for name, value in preset[stage].items() if value != defaults[stage][name]}
        changed.pop("field", None)  # the variant takes the field of the others
        assert own.keys() - {*levels} == changed.keys() - {*levels}
        assert all(own[name] == changed[name] for name in own.keys() - {*levels})
    for level in levels:
        distance = {**defaults["segment"], **printed["segment"]}[level] * defaults["fuse_object"]["clip_distance"]
        assert preset["segment"][level] * preset["fuse_object"]["clip_distance"] == pytest.approx(distance, abs=0.01)


def test_paper_preset_differs_from_the_defaults_where_it_speaks(defaults):
    paper = yaml.safe_load((ROOT / "config/presets/paper.yaml").read_text())
    assert any(paper[stage][name] != defaults[stage][name] for stage in paper for name in paper[stage])


def test_whole_numbers_given_for_real_ones_make_equal_parameters():
    declared = declared_stages()["depth"]
    settings = default_settings(declared)
    round_ones = {name: int(v) for name, v in settings.items() if isinstance(v, float) and v == int(v)}
    assert round_ones
    assert repr(make_params(declared, settings | round_ones)) == repr(make_params(declared, settings))


def test_sample_is_taken_when_nothing_is_given(defaults, monkeypatch):
    monkeypatch.chdir(ROOT)
    sequences = list_sequences(defaults, ROOT)
    assert sequences["sample"]["source"] == "resources/sample/video.mp4"
    assert sequences["sample"]["cameras"] is None
    assert sequences["sample"]["truth_cameras"] is not None


def test_video_takes_the_place_of_all_sequences(defaults, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("mug.v2.mp4").touch()
    config = {**defaults, "video": "mug.v2.mp4", "sequences": {"other": {"source": "nowhere"}}}
    assert list(list_sequences(config, ROOT)) == ["mug.v2"]


def test_keyframes_are_at_the_truth_only_where_that_is_asked_for(defaults, tmp_path, monkeypatch):
    """Contract: a sequence's own word goes before that of the run, and a missing file leaves none."""
    monkeypatch.chdir(tmp_path)
    Path("mug.mp4").touch()
    Path("masks").mkdir()
    plain = {"source": "mug.mp4", "truth": {"masks": "masks"}}
    entries = {
        "plain": plain,
        "yes": {**plain, "keyframes_at_truth": True},
        "no": {**plain, "keyframes_at_truth": False},
        "bare": {"source": "mug.mp4"},
        "lost": {**plain, "cameras": "nowhere", "keyframes_at_truth": True},
    }

    def masks(**config):
        found, _ = load_sequences({**defaults, "sequences": entries, **config}, ROOT)
        return {name: entry["keyframe_masks"] for name, entry in found.items()}

    nothing = dict.fromkeys(entries)
    assert masks() == {**nothing, "yes": "masks"}
    assert masks(keyframes_at_truth=True) == {**nothing, "plain": "masks", "yes": "masks"}
    assert all(
        entry["truth_masks"]
        for name, entry in list_sequences({**defaults, "sequences": entries}, ROOT).items()
        if name != "bare"
    )


@pytest.mark.parametrize("name", ["benchmark", "datasets/tabletop12", "datasets/real", "datasets/object_videos"])
def test_the_figures_of_the_benchmark_stay_over_all_true_masks(defaults, name):
    config = {**merged(defaults, yaml.safe_load((ROOT / f"config/{name}.yaml").read_text())), "skip_absent": False}
    sequences = list_sequences(config, ROOT)
    assert any(entry["truth_masks"] for entry in sequences.values())
    assert all(entry["keyframe_masks"] == entry["truth_masks"] for entry in sequences.values())


def test_so_do_those_of_the_sample(defaults):
    sample = list_sequences(defaults, ROOT)["sample"]
    assert sample["keyframe_masks"] == sample["truth_masks"] is not None


def test_absent_file_is_named_with_its_key(defaults, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    config = {**defaults, "sequences": {"mug": {"source": str(tmp_path), "truth": {"mesh": "mug.ply"}}}}
    config["sequences"]["pot"] = {"source": str(tmp_path), "cameras": None}
    sequences, missing = set_aside_missing(list_sequences(config, ROOT))
    assert sequences["mug"]["source"] is None and sequences["mug"]["dataset"] == "sample"
    assert sequences["pot"]["source"] == str(tmp_path)
    assert missing == {"mug": f"sequences.mug.truth.mesh: expected a file or folder, found no mug.ply in {tmp_path}."}


def test_a_sequence_may_belong_to_a_set_of_its_own(defaults, tmp_path):
    entries = {"mug": {"source": str(tmp_path), "dataset": "kitchen"}, "pot": {"source": str(tmp_path)}}
    config = {**defaults, "dataset": "house", "sequences": entries}
    check_configuration(config, configuration_schema())
    sequences = list_sequences(config, ROOT)
    assert (sequences["mug"]["dataset"], sequences["pot"]["dataset"]) == ("kitchen", "house")
    config["sequences"]["mug"]["dataset"] = "a/b"
    with pytest.raises(UserError, match=r"'a/b' cannot name .*sequences\.mug\.dataset"):
        check_configuration(config, configuration_schema())


MISFITS = {
    "empty list": ("edges", {"scales": []}, "edges.scales: expected at least 1 values, got 0"),
    "coupling": ("depth", {"coupling_decay": 0.1, "iterations": 10}, "coupling_decay \\* iterations below 1"),
    "even median": ("depth", {"median_size": 4}, "depth.median_size: expected one of 1, 3, 5, got 4"),
    "reaches": ("fuse_scene", {"region_least_reach": 2.0}, "fuse_scene: expected region_least_reach <= region_reach"),
    "least angle": ("keyframes", {"min_angle": 13}, "keyframes: expected min_angle <= max_angle <= widest_angle"),
    "widest angle": ("keyframes", {"widest_angle": 11}, "keyframes: expected min_angle <= max_angle <= widest_angle"),
    "neighbours": ("keyframes", {"neighbours": 3}, "keyframes: expected min_neighbours <= neighbours, got 4 and 3"),
    "depth range": ("keyframes", {"near_factor": 1.2}, "keyframes: expected near_factor < far_factor"),
    "short clip distance": ("fuse_object", {"clip_distance": 1.5}, "fuse_object.clip_distance: expected at least 2"),
}


@pytest.mark.parametrize("case", MISFITS)
def test_values_that_do_not_fit_each_other_are_refused_when_read(defaults, case):
    stage, values, sentence = MISFITS[case]
    with pytest.raises(UserError, match=sentence):
        check_configuration(merged(defaults, {stage: values}), configuration_schema())


def test_lists_that_are_empty_by_default_may_be_empty(defaults):
    check_configuration(merged(defaults, {"evaluate": {"cylinder_sequences": []}}), configuration_schema())


def test_absent_sequences_are_skipped_with_a_sentence_only_if_asked_for(defaults, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("mug.mp4").touch()
    config = {**defaults, "sequences": {"mug": {"source": "mug.mp4"}, "cup": {"source": "cup.mp4"}}}
    sequences, missing = load_sequences(config, ROOT)
    assert list(sequences) == ["mug", "cup"] and list(missing) == ["cup"]
    assert missing["cup"].startswith("sequences.cup.source: expected a file or folder, found no cup.mp4")
    said = io.StringIO()
    sequences, missing = load_sequences({**config, "skip_absent": True}, ROOT, said)
    assert list(sequences) == ["mug"] and not missing
    (line,) = said.getvalue().splitlines()
    assert line.startswith("threedfs: sequence cup is skipped: its source cup.mp4 is not in ")


def test_nothing_left_of_a_data_set_is_an_error(defaults, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    config = {**defaults, "skip_absent": True, "sequences": {"cup": {"source": "cup.mp4"}}}
    with pytest.raises(UserError, match=r"expected at least one whose source is there, found none of the 1 "):
        load_sequences(config, ROOT)


def test_absent_truth_of_a_present_sequence_is_missing_all_the_same(defaults, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("mug.mp4").touch()
    entry = {"source": "mug.mp4", "truth": {"masks": "masks"}}
    _, missing = load_sequences({**defaults, "skip_absent": True, "sequences": {"mug": entry}}, ROOT)
    assert missing["mug"].startswith("sequences.mug.truth.masks: expected a file or folder, found no masks")


TRIED = {
    "unknown": ({}, ["cup"], "expected names of sequences, got cup, which is none of them"),
    "no cameras": ({"truth": {"depth": "mug.mp4"}}, ["mug"], "of mug, found no cameras and no truth.cameras; give"),
    "no depth": (
        {"cameras": "mug.mp4", "truth": {"cameras": "mug.mp4"}},
        ["mug"],
        "of mug, found no truth.depth; give",
    ),
    "nothing to do": ({"object": False}, [], r"sequences\.mug: expected its name in depth_experiment\.sequences"),
}


@pytest.mark.parametrize("case", TRIED)
def test_sequences_that_cannot_take_part_in_the_depth_experiment_are_refused(defaults, case, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("mug.mp4").touch()
    entry, tried, sentence = TRIED[case]
    own = {"sequences": {"mug": {"source": "mug.mp4", **entry}}, "depth_experiment": {"sequences": tried}}
    with pytest.raises(UserError, match=sentence):
        load_sequences(merged(defaults, own), ROOT)


@pytest.mark.parametrize("what", ["mesh", "depth"])
def test_a_truth_without_its_cameras_is_refused(defaults, what, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("mug.mp4").touch()
    own = {"sequences": {"mug": {"source": "mug.mp4", "truth": {what: "mug.mp4"}}}}
    with pytest.raises(UserError, match=rf"sequences\.mug\.truth\.{what}: expected truth\.cameras beside it"):
        load_sequences(merged(defaults, own), ROOT)


def test_a_skipped_sequence_does_not_take_part_in_the_depth_experiment(defaults, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("mug.mp4").touch()
    files = {"source": "mug.mp4", "cameras": "mug.mp4", "truth": {"cameras": "mug.mp4", "depth": "mug.mp4"}}
    own = {"sequences": {"mug": files, "cup": {"source": "cup.mp4"}}, "skip_absent": True}
    found, _ = load_sequences(merged(defaults, {**own, "depth_experiment": {"sequences": ["cup", "mug"]}}), ROOT)
    assert {name: entry["depth_experiment"] for name, entry in found.items()} == {"mug": True}


def test_what_a_sequence_does_not_state_has_its_default(defaults, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("mug.mp4").touch()
    bare, full = {"source": "mug.mp4"}, {"source": "mug.mp4", "intrinsics": [1, 2, 3, 4], "truth": {"depth_scale": 10}}
    found, _ = load_sequences({**defaults, "sequences": {"bare": bare, "full": full}}, ROOT)
    assert (found["bare"]["intrinsics"], found["bare"]["depth_scale"], found["bare"]["object"]) == (None, 1000.0, True)
    assert (found["full"]["intrinsics"], found["full"]["depth_scale"]) == ([1, 2, 3, 4], 10)


def test_values_of_one_sequence_are_checked_like_those_of_the_run(defaults):
    def check(settings):
        entry = {"source": "mug.mp4", "settings": settings}
        check_configuration({**defaults, "sequences": {"mug": entry}}, configuration_schema())

    check({"depth": {"photometric_weight": 10}})
    with pytest.raises(UserError, match=r"sequences\.mug\.settings\.depth: unknown key wieght"):
        check({"depth": {"wieght": 10}})
    with pytest.raises(UserError, match=r"sequences\.mug\.settings\.depth\.photometric_weight: expected more than 0"):
        check({"depth": {"photometric_weight": -1}})
    with pytest.raises(UserError, match="expected min_angle <= max_angle"):
        check({"keyframes": {"max_angle": 1}})
    with pytest.raises(UserError, match="expected no names of sequences"):
        check({"depth_experiment": {"sequences": ["mug"]}})
