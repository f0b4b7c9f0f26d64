"""Rejection: a wrong configuration ends at once, with one sentence and a status that is not 0."""

from __future__ import annotations

import os

import pytest

CASES = {
    "unknown key": ("colour: red", "unknown key colour"),
    "out of range": ("depth: {iterations: -1}", "depth.iterations: expected at least 1, got -1"),
    "slash in name": ("sequences: {a/b: {source: config}}", "'a/b' cannot name a sequence"),
    "no such file": (
        "sequences: {mug: {source: mug.mp4}}",
        "sequences.mug.source: expected a file or folder, found no",
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
    "unknown method": ("methods: [magic]", "methods.0: expected one of fused_sdf"),
    "not a number": ("depth: {photometric_weight: .nan}", "expected a finite number, got nan"),
    "name that is a number": ("sequences: {7: {source: config}}", "put it in quotes, as '7'"),
    "store that is a file": ("store: Snakefile", "store: expected a folder to write to, found a file at Snakefile"),
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


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["--cores", "-3"], "threedfs: --cores: expected a whole number of at least 1, got -3."),
        (["--config", "depth={iterations: many}"], "threedfs: configuration, depth.iterations: expected integer"),
    ],
)
def test_wrong_command_lines_end_with_one_sentence(project, arguments, sentence):
    output = project.run(*arguments, good=False)
    assert sentence in output and "Traceback" not in output
    assert not (project.folder / "results").exists()


def test_parameters_in_brackets_are_taken_from_the_command_line(project):
    project.run("-n", "--config", "depth={iterations: 5}")


def spoil(project, sentence):
    """Let the look at the inputs find a fault in every sequence whose source is called so."""
    (project.package / "inputs/look.py").write_text(
        "from threedfs.errors import UserError\n\n\ndef look(entry, frames):\n"
        f"    if 'bad' in entry['source']:\n        raise UserError({sentence!r})\n    return ['a truth looks odd.']\n"
    )


def test_what_cannot_be_used_is_refused_before_any_work_by_a_dry_run_too(project):
    (project.folder / "bad.mp4").write_text("bad")
    (project.folder / "bad.yaml").write_text("sequences: {one: {source: bad.mp4}}\n")
    spoil(project, "bad.mp4: expected a video.")
    for arguments in (["-n"], [], ["--keep-going"]):
        output = project.run("--configfile", "bad.yaml", *arguments, good=False)
        (line,) = (line for line in output.splitlines() if line.startswith("threedfs: "))
        assert line == "threedfs: inputs of one: bad.mp4: expected a video."
        assert "Traceback" not in output
    assert not (project.folder / "results/one").exists()


def test_of_several_sequences_the_sound_ones_are_finished(project):
    for name in ("bad.mp4", "good.mp4"):
        (project.folder / name).write_text(name)
    (project.folder / "two.yaml").write_text("sequences: {one: {source: bad.mp4}, two: {source: good.mp4}}\n")
    spoil(project, "bad.mp4: expected a video.")
    targets = [f"results/{name}/01_frames/frames.zarr.zip" for name in ("one", "two")]
    output = project.run("--configfile", "two.yaml", "--keep-going", "--", *targets, good=False)
    assert "threedfs: frames of one: bad.mp4: expected a video." in output
    assert output.count("note: inputs of two: a truth looks odd.") == 1
    assert [(project.folder / target).is_file() for target in targets] == [False, True]


def test_a_file_counts_by_its_content_and_not_by_its_time(project):
    video, frames = project.folder / "mug.mp4", "results/mug/01_frames/frames.zarr.zip"
    (project.folder / "mug.yaml").write_text("sequences: {mug: {source: mug.mp4}}\n")
    for content in ("first", "another"):
        video.write_text(content)
        os.utime(video, (1e9, 1e9))
        assert "Nothing to be done" not in project.run("--configfile", "mug.yaml", "--", frames)


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
