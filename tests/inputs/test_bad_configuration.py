"""Rejection: configurations that cannot be meant, each with the words that its sentence must have."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

import threedfs
from threedfs.cli.main import main
from threedfs.cli.request import name_sequence, read_settings
from threedfs.cli.workflow import Outcome
from threedfs.errors import UserError
from threedfs.inputs.places import check_places
from threedfs.params.command_line import read_scalars
from threedfs.params.configuration import LONGEST_NAME, configuration_schema
from threedfs.params.sequences import load_sequences

ROOT = Path(__file__).resolve().parents[2]
DEEP = "".join(f"{{a{level}: " for level in range(30)) + "1" + "}" * 30

CASES = {
    "unknown parameter": ("depth: {iteratons: 5}", "depth: unknown key iteratons; did you mean iterations?"),
    "unknown stage": ("depht: {iterations: 5}", "unknown key depht; did you mean depth?"),
    "parameter without its stage": ("smoothness_growth: 2", "smoothness_growth; it is a key of depth."),
    "wrong type": ("depth: {iterations: many}", "depth.iterations: expected integer, got 'many'"),
    "no such choice": ("depth: {prior: third_order}", "depth.prior: expected one of first_order"),
    "space in name": ("sequences: {a b: {source: config}}", "'a b' cannot name a sequence"),
    "no such mask": (
        "sequences: {mug: {source: config, truth: {masks: m}}}",
        "sequences.mug.truth.masks: expected a file or folder, found no m",
    ),
    "no source": ("sequences: {mug: {cameras: config}}", "sequences.mug: expected the key source"),
    "source and take": (
        "sequences: {mug: {source: config, rendered: books}}",
        "sequences.mug: expected no source beside rendered",
    ),
    "no such take": ("sequences: {mug: {rendered: mug}}", "sequences.mug.rendered: expected one of books,"),
    "true cameras of a video": (
        "sequences: {mug: {source: config, true_cameras: true}}",
        "sequences.mug.true_cameras: only a rendered sequence has them",
    ),
    "odd width": ("render: {width: 100}", "render.width: expected a multiple of 8, got 100"),
    "variant of nothing": (
        "methods: [tsdf]\nvariants: {a: {}}",
        "variants: expected a method that has variants, one of",
    ),
    "variant of another stage": ("variants: {a: {depth: {}}}", "variants.a: unknown key depth"),
    "variant out of range": (
        "methods: [gc_select]\nvariants: {a: {segment: {link_weight: -1}}}",
        "variants.a.segment.link_weight: expected at least 0.0, got -1",
    ),
    "name of the run's own": (
        "sequences: {tables: {source: config}}",
        "expected other names than README.md, benchmarks",
    ),
    "cylinder of nothing": (
        "evaluate: {cylinder_sequences: [mgu]}",
        "evaluate.cylinder_sequences: expected names of sequences, got mgu, which is none of them",
    ),
    "space in a variant": (
        "methods: [gc_select]\nvariants: {a b: {segment: {table: false}}}",
        "'a b' cannot name a variant",
    ),
    "one method without brackets": (
        "methods: tsdf",
        "methods: expected a list, got 'tsdf'; write a list, as in [tsdf]",
    ),
    "file in place of keys": ("sequences: {mug: mug.mp4}", "sequences.mug: expected keys with values, got 'mug.mp4'; "),
    "negative seed": ("seed: -1", "seed: expected at least 0, got -1"),
    "NaN": ("depth: {photometric_weight: .nan}", "depth.photometric_weight: expected a finite number, got nan"),
    "infinity": (
        "evaluate: {mesh_thresholds: [.inf]}",
        "evaluate.mesh_thresholds.0: expected a finite number, got inf",
    ),
    "NaN of a sequence": (
        "sequences: {a: {source: config, settings: {depth: {photometric_weight: .nan}}}}",
        "sequences.a.settings.depth.photometric_weight: expected a finite number",
    ),
    "NaN of a variant": (
        "methods: [gc_select]\nvariants: {a: {segment: {link_weight: -.inf}}}",
        "variants.a.segment.link_weight: expected a finite number, got -inf",
    ),
    "NaN intrinsics": (
        "sequences: {a: {source: config, intrinsics: [.nan, 1, 1, 1]}}",
        "sequences.a.intrinsics.0: expected a finite number",
    ),
    "large seed": ("seed: 4294967296", "seed: expected a whole number up to 2147483647, got one of 10 digits"),
    "huge number": (f"seed: 1{'0' * 999}", "got one of 1000 digits"),
    "seed of a fraction": ("seed: 1.0", "seed: expected integer, got 1.0"),
    "seed that is true": ("seed: true", "seed: expected integer, got True"),
    "whole number with a point": ("depth: {iterations: 5.0}", "depth.iterations: expected integer, got 5.0"),
    "seven": ("sequences: {7: {source: config}}", "sequences: expected a name, got 7, which YAML reads as another"),
    "true": ("sequences: {true: {source: config}}", "put it in quotes, as 'true'"),
    "null": ("sequences: {null: {source: config}}", "put it in quotes, as 'null'"),
    "key on top": ("7: 8", "configuration: expected a name, got 7"),
    "date": ("sequences: {2024-01-01: {source: config}}", "put it in quotes, as '2024-01-01'"),
    "number of a stage": ("depth: {1: 2}", "configuration, depth: expected a name, got 1"),
    "line break": ('sequences: {"abc\\n": {source: config}}', r"'abc\n' cannot name a sequence"),
    "long name": (
        f"sequences: {{{'x' * 261}: {{source: config}}}}",
        "at most 100, because results are put in a folder",
    ),
    "long variant": (f"methods: [gc_select]\nvariants: {{{'x' * 101}: {{}}}}", "cannot name a variant"),
    "long data set": (f"dataset: {'x' * 261}", "at most 100"),
    "data set with a line break": ('dataset: "a\\n"', r"'a\n' cannot name a data set"),
    "no name": ("sequences: {'': {source: config}}", "'' cannot name a sequence"),
    "parent": ("sequences: {..: {source: config}}", "'..' cannot name a sequence"),
    "deep": (f"depth: {DEEP}", "expected at most 20 levels of keys, got more"),
    "enormous film": ("render: {width: 1000000000}", "render.width: expected at most 8192, got 1000000000"),
    "stage of null": ("depth: null", "configuration, depth: expected keys with values, got None"),
    "stage of a number": ("depth: 5", "configuration, depth: expected keys with values, got 5"),
    "no store": ('store: ""', "store"),
    "mesh without cameras": (
        "sequences: {a: {source: config, truth: {mesh: Snakefile}}}",
        "sequences.a.truth.mesh: expected truth.cameras beside it",
    ),
    "three intrinsics": (
        "sequences: {a: {source: config, intrinsics: [1, 2, 3]}}",
        "expected at least 4 values, got 3",
    ),
    "no methods": ("methods: []", "methods: expected at least 1 values, got 0"),
    "absent truth": (
        "sequences: {a: {source: config, truth: {masks: lost}}}",
        "sequences.a.truth.masks: expected a file or folder, found no lost",
    ),
    "path with a variable of Snakemake": (
        'sequences: {a: {source: "film <results>.mp4"}}',
        "sequences.a.source: expected a path without <results>, which Snakemake would replace",
    ),
    "path with a wildcard of Snakemake": (
        'sequences: {a: {source: config, truth: {masks: "{sequence} masks"}}}',
        "sequences.a.truth.masks: expected a path without {sequence}, which Snakemake would replace",
    ),
    "video with a space": ("video: config/my mug.mp4", "found no config/my mug.mp4"),
}


PLAIN = ("film {1-2}.mp4", "film {a b}.mp4", "film {}.mp4", "film <1>.mp4")


def merge(text: str) -> dict:
    """Lay a configuration over the defaults, as Snakemake does."""
    config = yaml.safe_load((ROOT / "config/config.yaml").read_text())
    for key, value in yaml.safe_load(text).items():
        section = config.get(key)
        config[key] = {**section, **value} if isinstance(section, dict) and isinstance(value, dict) else value
    return config


@pytest.mark.parametrize("case", CASES)
def test_configurations_that_cannot_be_meant(case, monkeypatch):
    text, words = CASES[case]
    monkeypatch.chdir(ROOT)
    with pytest.raises(UserError) as fault:
        _, missing = load_sequences(merge(text), ROOT)
        raise UserError(" ".join(missing.values()))
    assert words in str(fault.value) and "\n" not in str(fault.value) and len(str(fault.value)) < 1000


@pytest.mark.parametrize("name", PLAIN)
def test_names_that_snakemake_leaves_are_taken(name, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    (tmp_path / name).touch()
    sequences, missing = load_sequences(merge(f"sequences: {{a: {{source: '{name}'}}}}"), ROOT)
    assert sequences["a"]["source"] == name and not missing


@pytest.mark.parametrize(
    ("given", "value"),
    [
        ({"depth": {"iterations": "5"}}, 5),
        ({"depth": {"iterations": "many"}}, "many"),
        ({"evaluate": {"mesh_thresholds": ["0.5", "1"]}}, [0.5, 1]),
        ({"depth": {"prior": "first_order"}}, "first_order"),
        ({"sequences": {"a": {"source": "1", "object": "false"}}}, {"source": "1", "object": False}),
    ],
)
def test_values_in_brackets_on_the_command_line_are_read(given, value):
    read_scalars(given, given, configuration_schema())
    ((found,),) = (section.values() for section in given.values())
    assert found == value


def test_text_of_a_file_stays_text():
    config = {"depth": {"iterations": "5"}}
    read_scalars(config, {}, configuration_schema())
    assert config == {"depth": {"iterations": "5"}}


@pytest.mark.parametrize(
    ("store", "results", "words"),
    [
        ("file", "results", "store: expected a folder to write to, found a file at file"),
        ("file/store", "results", "store: expected a folder to write to, found a file at file"),
        ("results/.store", "file", "results: expected a folder to write to, found a file at file"),
        ("link", "results", "store: expected a folder to write to, found a file at link"),
        ("/proc/store", "results", "store: expected"),
        ("store", "made", "results: expected a folder to write to, found a file at made/mug"),
    ],
)
def test_places_that_cannot_be_written_to(tmp_path, monkeypatch, store, results, words):
    monkeypatch.chdir(tmp_path)
    Path("file").touch()
    Path("link").symlink_to("nowhere")
    Path("made").mkdir()
    Path("made/mug").touch()
    before = sorted(tmp_path.rglob("*"))
    with pytest.raises(UserError, match=words):
        check_places(Path(store), Path(results), ["mug"])
    assert sorted(tmp_path.rglob("*")) == before


def test_a_read_only_place_and_a_full_disk_are_told_apart(tmp_path, monkeypatch):
    check_places(tmp_path / "a/b/store", tmp_path / "results", ["mug"])
    monkeypatch.setattr("os.access", lambda place, mode: False)
    with pytest.raises(UserError, match="is read-only; run in another folder"):
        check_places(tmp_path / "store", tmp_path / "results")
    monkeypatch.undo()
    monkeypatch.setattr("threedfs.inputs.places._LEAST_FREE", 10**18)
    with pytest.raises(UserError, match="MB left; free some"):
        check_places(tmp_path / "store", tmp_path / "results")


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["run", "lost.mp4"], "lost.mp4: expected a video or a folder of photos, found nothing there"),
        (["run", ".", "--height", "tall"], "--height: expected a length such as 95mm"),
        (["run", ".", "--height", "nan"], "--height: expected a length"),
        (["run", ".", "--set", "depth"], "--set: expected STAGE.PARAMETER=VALUE"),
        (["run", ".", "--set", "depth.iterations=[5"], "--set: expected a value after depth.iterations="),
        (["run", ".", "--set", "depth.iterations=2024-99-99"], "--set: expected a value after depth.iterations="),
        (["run", ".", "--set", "video=a.mp4"], "videos are given without --set"),
        (["show", "nowhere"], "expected the report of a run, found none"),
        (["export", ".", "a.stl"], "expected the mesh of a run, found none"),
        (["export", "nowhere", "a.stl"], "nowhere: expected the folder of a sequence, as results/my, found none"),
        (["export", ".", "nowhere/a.stl"], "nowhere/a.stl: expected a folder to write into, found no nowhere"),
    ],
)
def test_the_command_refuses_in_one_sentence(words, sentence, capsys):
    assert main(words) == 1
    assert sentence in capsys.readouterr().err


def test_the_command_refuses_cores_that_there_cannot_be(capsys):
    for cores in ("-3", "0", "two"):
        with pytest.raises(SystemExit) as end:
            main(["run", ".", f"--cores={cores}"])
        assert end.value.code == 2
        assert f"expected a whole number of at least 1, got '{cores}'" in capsys.readouterr().err


def test_what_is_refused_before_the_first_job_is_as_if_it_had_not_been_asked_for():
    for fault, refused in {
        "inputs of mug: mug.mp4: expected a video": True,
        "configuration: unknown key depht": True,
        "frames of mug: mug.mp4: expected a video": False,
    }.items():
        assert Outcome(1, False, (fault,), Path("run.txt")).refused is refused


def test_the_package_tells_its_version_and_what_it_offers(capsys):
    with pytest.raises(SystemExit) as end:
        main(["--version"])
    assert end.value.code == 0 and capsys.readouterr().out == f"threedfs {threedfs.__version__}\n"
    assert dir(threedfs) == ["__version__", "open", "reconstruct"]


def test_long_names_of_videos_are_cut_and_told_apart():
    first, second = (name_sequence(Path(f"{'long ' * 45}{end}.mp4")) for end in "ab")
    assert first != second and len(first) == len(second) == LONGEST_NAME


def test_settings_that_are_no_yaml_are_refused():
    with pytest.raises(UserError, match="expected a value after depth"):
        read_settings(["depth.iterations={"])
