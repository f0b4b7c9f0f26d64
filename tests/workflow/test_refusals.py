"""Rejection: a wrong configuration ends at once, with one sentence and a status that is not 0."""

from __future__ import annotations

import pytest

CASES = {
    "unknown key": ("colour: red", "unknown key colour"),
    "unknown parameter": ("depth: {iteratons: 5}", "depth: unknown key iteratons"),
    "wrong type": ("depth: {iterations: many}", "depth.iterations: expected integer, got 'many'"),
    "out of range": ("depth: {iterations: -1}", "depth.iterations: expected at least 1, got -1"),
    "no such choice": ("depth: {prior: third_order}", "depth.prior: expected one of first_order"),
    "slash in name": ("sequences: {a/b: {source: config}}", "'a/b' cannot name a sequence"),
    "space in name": ("sequences: {a b: {source: config}}", "'a b' cannot name a sequence"),
    "no such file": (
        "sequences: {mug: {source: mug.mp4}}",
        "sequences.mug.source: expected a file or folder, found no",
    ),
    "no such mask": (
        "sequences: {mug: {source: config, truth: {masks: m}}}",
        "sequences.mug.truth.masks: expected a file or folder, found no m",
    ),
    "two sizes": (
        "sequences: {mug: {source: config, scale: {tag: 4cm, height: 9cm}}}",
        "sequences.mug.scale: expected one of tag, board and height, got tag and height",
    ),
    "no length": (
        "sequences: {mug: {source: config, scale: {board: {corners: [9, 6], square: wide}}}}",
        "sequences.mug.scale.board.square: expected a length such as 95mm",
    ),
    "height of no mesh": (
        "methods: [gc_2d]\nsequences: {mug: {source: config, scale: {height: 9cm}}}",
        "sequences.mug.scale.height: expected a method with a mesh",
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
    "unknown method": ("methods: [magic]", "methods.0: expected one of fused_sdf"),
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
}


@pytest.mark.parametrize("case", CASES)
def test_wrong_configuration_ends_with_one_sentence(project, case):
    text, sentence = CASES[case]
    (project.folder / "wrong.yaml").write_text(text + "\n")
    output = project.run("--configfile", "wrong.yaml", good=False)
    (line,) = (line for line in output.splitlines() if line.startswith("threedfs: "))
    assert sentence in line
    assert "Traceback" not in output
    assert not (project.folder / "results").exists()


def test_skipped_sequences_are_named_once_at_the_start(project):
    sequences = "sequences: {here: {source: config}, gone: {source: gone.mp4}}"
    (project.folder / "some.yaml").write_text(f"skip_absent: true\n{sequences}\n")
    output = project.run("--configfile", "some.yaml", "--", "results/here/01_frames/frames.zarr.zip")
    assert output.count("threedfs: sequence gone is skipped: its source gone.mp4 is not in ") == 1
    assert (project.folder / "results/here/01_frames/frames.zarr.zip").is_file()


def test_missing_video_ends_with_one_sentence(project):
    output = project.run("--config", "video=nowhere.mp4", good=False)
    assert "threedfs: video: expected a video file or a folder of photos, found no nowhere.mp4" in output


def test_video_whose_name_cannot_name_a_sequence_is_refused(project):
    (project.folder / "my mug.mp4").touch()
    output = project.run("--config", "video=my mug.mp4", good=False)
    assert "'my mug' cannot name a sequence" in output


def test_what_a_stage_refuses_ends_the_run_with_its_sentence(project):
    project.edit(
        "src/threedfs/stages/frames.py",
        "    write(",
        "    from threedfs.errors import UserError\n    raise UserError('this is no video.')\n    write(",
    )
    output = project.run(good=False)
    assert "Traceback" not in output
    assert "threedfs: frames of sample: this is no video." in output.splitlines()
    assert not (project.folder / "results/sample/01_frames/frames.zarr.zip").exists()
