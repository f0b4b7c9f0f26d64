"""Contract: what runs, what does not run again, and what a changed input, parameter or source file reruns."""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import signal
import subprocess
import time
from collections import Counter

import pytest

from threedfs.store.files import remove_abandoned

RULES = (
    "render calibrate frames features poses keyframes shrink scout depth consistency fuse_scene locate crops cues "
    "fuse_object locate_object object evaluate_reconstruction evaluate collect all"
).split()
FILMED = ("video.mp4", "cameras.json", "mesh.ply")


def jobs_that_say(output: str, what: str) -> Counter:
    """Count the jobs, and of those on keyframes the keyframes, that say something, by rule.

    It may stand behind a line of Snakemake, which writes the ends of its lines apart.
    """
    return Counter(re.findall(rf"\b(\w+) of [^:\n]*: {what}", output))


def jobs_done(output: str) -> Counter:
    """Count those that computed."""
    return jobs_that_say(output, "done in")


def records(results, sequence):
    """Read the action records that a sequence's logs name."""
    logs = (log.read_text() for log in (results / sequence / "logs").rglob("*.log"))
    keys = (key for log in logs for key in re.findall(r"^action (\w+)$", log, re.MULTILINE))
    return [json.loads((results / ".store/actions" / key[:2] / f"{key}.json").read_text()) for key in keys]


def jobs_taken(output: str) -> Counter:
    """Count those that the store answered."""
    return jobs_that_say(output, "taken from the store in")


def test_lists_every_rule(project):
    listed = project.run("--list-rules").split()
    assert set(RULES) <= set(listed)


def test_first_run_does_every_job_and_prints_the_summary(first_run):
    project, output = first_run
    once = set(RULES) - {"render", "calibrate", "all"}
    two_keyframes, two_scopes = {"scout": 2, "cues": 2}, {"depth": 4, "consistency": 2}
    assert jobs_done(output) == Counter({**dict.fromkeys(once, 1), **two_keyframes, **two_scopes})
    assert re.search(r"sample fused_sdf +0.500", output)
    assert (project.folder / "results/metrics.csv").is_file()


def test_second_run_does_nothing(finished):
    assert "Nothing to be done" in finished.run()


def test_wiped_results_are_taken_from_the_store_with_the_same_bytes(finished, first_run):
    artifacts = finished.artifacts()
    for path in (finished.folder / "results").iterdir():
        if path.name != ".store":
            shutil.rmtree(path) if path.is_dir() else path.unlink()
    output = finished.run()
    assert jobs_done(output) == Counter()
    assert jobs_taken(output) == jobs_done(first_run[1])
    assert finished.artifacts() == artifacts


def test_changed_parameter_reruns_what_follows_and_flipped_back_nothing(finished):
    (finished.folder / "other.yaml").write_text("depth: {iterations: 7}\n")
    done = jobs_done(finished.run("--configfile", "other.yaml"))
    assert done["depth"] == 4  # of two keyframes, in the scene and in their crops
    fused = {"consistency", "fuse_scene", "locate", "crops", "cues", "fuse_object", "locate_object", "object"}
    assert set(done) == {"depth", *fused, "evaluate_reconstruction", "evaluate"}
    output = finished.run()
    assert jobs_done(output) == Counter()
    assert jobs_taken(output)["depth"] == 4


def test_changed_crops_rerun_what_follows_and_nothing_before(finished):
    """Contract: neither frames, poses and keyframes nor the scene pass are done again; a dry run tells."""
    (finished.folder / "other.yaml").write_text("crops: {pixels: 50000}\n")
    planned = dict(re.findall(r"^(\w+) +(\d+)$", finished.run("--configfile", "other.yaml", "-n"), re.MULTILINE))
    followers = ("crops", "cues", "depth", "consistency", "fuse_object", "locate_object", "object")
    once = {*followers, "evaluate_reconstruction", "evaluate", "collect", "all"}
    assert planned == {**dict.fromkeys(once, "1"), "total": str(len(once))}
    output = finished.run("--configfile", "other.yaml")
    assert set(jobs_taken(output)) <= {"collect"} and jobs_done(output)["depth"] == 2


def test_changed_parameter_of_one_stage_of_a_rule_leaves_the_others(finished):
    (finished.folder / "other.yaml").write_text("superpixels: {area: 77}\n")
    output = finished.run("--configfile", "other.yaml")
    at_work = jobs_that_say(output, "at work")
    assert at_work == Counter(superpixels=2) and set(jobs_done(output)) == {"cues"}


def test_edited_source_reruns_its_stage_and_what_follows(finished):
    finished.edit("src/threedfs/stages/fuse_object.py", "write(", "print(end='') or write(")
    output = finished.run()
    assert set(jobs_done(output)) == {"fuse_object"}  # its bytes are as before, so all that follows is a hit
    assert not {"depth", "consistency", "fuse_scene", "locate"} & set(jobs_taken(output))


def test_edited_comment_reruns_nothing(finished):
    finished.edit("src/threedfs/stages/depth.py", '"""Stand-in for a stage."""', '"""Reworded."""  # and a comment')
    assert "Nothing to be done" in finished.run()


def test_another_version_of_a_library_reruns_the_stages_that_use_it(finished):
    """Contract: Snakemake notices it, and the store does not take what the version before had made."""
    finished.edit("src/threedfs/stages/fuse_object.py", "def run", "import maxflow\n\n\ndef run")
    assert jobs_done(finished.run())["fuse_object"] == 1
    assert "Nothing to be done" in finished.run()
    finished.edit(
        "src/threedfs/store/code.py",
        "return version(distribution)",
        'return version(distribution) + "+next" * (distribution == "PyMaxflow")',
    )
    assert jobs_done(finished.run()) == Counter(fuse_object=1)
    assert "Nothing to be done" in finished.run()


def test_touched_input_reruns_nothing_that_computes(finished):
    (finished.folder / "resources/sample/video.mp4").touch()
    assert jobs_done(finished.run()) == Counter()


def test_cores_do_not_change_a_byte(finished):
    first = finished.artifacts()
    shutil.rmtree(finished.folder / "results")
    finished.run("--cores", "1")
    assert finished.artifacts() == first


def test_forked_jobs_make_the_same_bytes(finished):
    whole = finished.artifacts()
    shutil.rmtree(finished.folder / "results")
    told = "    import sys\n    job.progress.note('forked' if 'numba' in sys.modules else 'alone')\n    write("
    finished.edit("src/threedfs/stages/evaluate.py", "    write(", told)
    done = subprocess.run(finished.command, cwd=finished.folder, env=finished.forking, check=True, capture_output=True)
    assert b"evaluate of sample fused_sdf: forked" in done.stderr
    assert finished.artifacts() == whole


def test_photo_edited_in_place_is_noticed(project):
    photos = project.folder / "photos"
    photos.mkdir()
    for name in ("a.jpg", "b.jpg"):
        (photos / name).write_text(name)
    order = ("results/photos/01_frames/frames.zarr.zip", "--config", "video=photos")
    assert jobs_done(project.run(*order)) == Counter(frames=1)
    assert "Nothing to be done" in project.run(*order)
    (photos / "a.jpg").write_text("edited")
    assert jobs_done(project.run(*order)) == Counter(frames=1)


def test_given_cameras_and_calibration_reach_their_stages(project):
    for name in ("shots", "cameras", "boards"):
        (project.folder / name).mkdir()
        (project.folder / name / "000001.txt").write_text(name)
    entry = "{source: shots, cameras: cameras, calibration: boards, truth: {masks: shots}}"
    (project.folder / "own.yaml").write_text(f"dataset: own\nsequences: {{mug: {entry}}}\n")
    done = jobs_done(project.run("--configfile", "own.yaml"))
    assert done["calibrate"] == 1 and done["evaluate"] == 1
    poses = json.loads((project.folder / "results/mug/02_poses/poses.json").read_text())
    assert all(poses["inputs"][name] is not None for name in ("frames", "cameras", "calibration"))
    assert "own,mug,fused_sdf" in (project.folder / "results/metrics.csv").read_text()


def give_truth(project, text=""):
    """Write a configuration of one sequence, with a truth that lies beside it, or whatever `text` says."""
    for name in ("mug.mp4", "cameras.json", "mesh.ply"):
        (project.folder / name).write_text(name)
    (project.folder / "masks").mkdir(exist_ok=True)
    (project.folder / "masks/000001.png").write_text("mask")
    (project.folder / "mug.yaml").write_text(f"sequences: {{mug: {{source: mug.mp4{text}}}}}\n")
    return "--configfile", "mug.yaml"


TRUTH = ", truth: {masks: masks, cameras: cameras.json, mesh: mesh.ply}, intrinsics: [1, 1, 1, 1]"
SCORING = Counter(evaluate_reconstruction=1, evaluate=1, collect=1)


def test_a_truth_given_later_runs_the_scoring_and_changes_nothing_else(project):
    """Contract: neither frames nor keyframes look at it, and taken away again, or edited, it costs as little."""
    project.run(*give_truth(project))
    made = {name: data for name, data in project.artifacts().items() if name.startswith("mug/0") or "11_object" in name}
    order = give_truth(project, TRUTH)
    planned = dict(re.findall(r"^(\w+) +(\d+)$", project.run(*order, "-n"), re.MULTILINE))
    assert planned == {**dict.fromkeys((*SCORING, "all"), "1"), "total": "4"}
    output = project.run(*order)
    assert jobs_done(output) + jobs_taken(output) == SCORING
    assert {name: project.artifacts()[name] for name in made} == made
    (record,) = (r for r in records(project.folder / "results", "mug") if r["stage"] == "evaluate")
    assert all(record["inputs"][name] for name in ("masks_truth", "cameras_truth", "mesh_truth"))
    (project.folder / "masks/000001.png").write_text("edited")
    assert set(jobs_done(project.run(*order))) <= set(SCORING)
    output = project.run(*give_truth(project))
    assert jobs_done(output) == Counter() and set(jobs_taken(output)) == set(SCORING)


def test_keyframes_at_truth_are_chosen_by_the_masks_for_the_whole_run_or_a_sequence(project):
    """Contract: frames and keyframes get the masks then, under the names that they have had in the store."""
    at_truth = ", keyframes_at_truth: true"
    (project.folder / "all.yaml").write_text("keyframes_at_truth: true\n")
    for text, files in ((TRUTH, ["all.yaml"]), (TRUTH + at_truth, [])):
        order = [*give_truth(project, text), *files]
        project.run("results/mug/03_keyframes/keyframes.json", *order)
        for place in ("01_frames/frames.zarr.zip", "03_keyframes/keyframes.json"):
            assert json.loads((project.folder / "results/mug" / place).read_text())["inputs"]["masks"]
    output = project.run("results/mug/03_keyframes/keyframes.json", *give_truth(project, TRUTH))
    assert jobs_done(output)["frames"] == jobs_done(output)["keyframes"] == 1
    assert json.loads((project.folder / "results/mug" / place).read_text())["inputs"]["masks"] is None


def test_rendered_sequences_of_one_take_are_filmed_once_and_bring_their_truth(project):
    text = "sequences: {one: {rendered: books}, other: {rendered: books, true_cameras: true}}\n"
    (project.folder / "own.yaml").write_text(text)
    output = project.run("--configfile", "own.yaml")
    assert jobs_done(output)["render"] == 1 and jobs_taken(output)["render"] == 0
    assert not (project.folder / "results/other/00_render").exists()
    # Two equal jobs may run side by side; then both compute.
    assert jobs_done(output)["frames"] + jobs_taken(output)["frames"] == 2 and jobs_done(output)["poses"] == 2
    results = project.folder / "results"
    filmed = {name: hashlib.sha256((results / f"one/00_render/{name}").read_bytes()).hexdigest() for name in FILMED}
    for sequence, cameras in (("one", None), ("other", filmed["cameras.json"])):
        frames = zip(("frames/source", "poses/cameras"), (filmed["video.mp4"], cameras), strict=True)
        for name, expected in frames:
            stage, key = name.split("/")
            (record,) = (r for r in records(results, sequence) if r["stage"] == stage)
            assert record["inputs"][key] == expected
        for stage, other in (("evaluate", "masks_truth"), ("evaluate_reconstruction", "depth_truth")):
            (record,) = (r for r in records(results, sequence) if r["stage"] == stage)
            assert record["inputs"]["cameras_truth"] == filmed["cameras.json"]
            assert record["inputs"]["mesh_truth"] == filmed["mesh.ply"]
            assert record["inputs"][other] is not None
    assert "Nothing to be done" in project.run("--configfile", "own.yaml")


def test_edited_object_films_its_takes_again_and_no_other(project):
    (project.folder / "own.yaml").write_text("sequences: {a: {rendered: books}, b: {rendered: teabox}}\n")
    order = ("results/a/00_render/video.mp4", "results/b/00_render/video.mp4", "--configfile", "own.yaml")
    assert jobs_done(project.run(*order)) == Counter(render=2)
    project.edit("src/threedfs/synthetic/objects/books.py", "seed: int = 61", "seed: int = 62")
    assert jobs_done(project.run(*order)) == Counter(render=1)


def test_methods_share_what_they_have_in_common(finished):
    """Contract: each further method adds its own stages and runs nothing again."""
    methods = ("fused_sdf", "deformed_sdf", "tsdf", "soft_maximum", "hard_maximum")
    (finished.folder / "all.yaml").write_text(f"methods: [{', '.join(methods)}, poisson]\n")
    output = finished.run("--configfile", "all.yaml")
    expected = {"stereo": 2, "densify": 1, "deform": 1, "fuse_baseline": 3, "poisson": 1, "evaluate": 5}
    expected |= {"locate_object": 4, "object": 4}
    assert jobs_done(output) == Counter({**expected, "collect": 1})
    results = finished.folder / "results/sample"
    fields = set()
    for method in methods:
        made = json.loads((results / f"11_object/{method}/mesh.ply").read_text())["inputs"]
        found = results / f"07_fusion/located/{method}.zarr.zip"
        assert made["located"] == hashlib.sha256(found.read_bytes()).hexdigest()
        assert made["field"] == json.loads(found.read_text())["inputs"]["volume"]
        fields.add(made["field"])
    assert len(fields) == 5
    patches = json.loads((finished.folder / "results/sample/05_stereo/000001.zarr.zip").read_text())
    assert patches["inputs"]["support"] is not None and patches["names"] == {"keyframe": "000001"}
    assert "Nothing to be done" in finished.run("--configfile", "all.yaml")


@pytest.mark.parametrize(
    ("engine", "gpu", "matched_here", "asked"),
    [
        ("cuda", False, False, False),  # refused by the stage, where the job runs
        ("auto", True, False, True),
        ("auto", False, True, False),
        ("cpu", True, True, False),
    ],
)
def test_patches_are_matched_here_unless_the_gpu_does(finished, engine, gpu, matched_here, asked):
    """Contract: the configuration decides, and what can be had where it leaves that open."""
    if gpu:
        finished.edit("src/threedfs/colmap/workspace.py", "return bool(pycolmap.has_cuda) and", "return True or")
    (finished.folder / "gpu.yaml").write_text(f"methods: [deformed_sdf]\ndensify: {{engine: {engine}}}\n")
    output = finished.run("--configfile", "gpu.yaml")
    assert jobs_done(output)["stereo"] == 2 * matched_here and jobs_done(output)["densify"] == 1
    cloud = json.loads((finished.folder / "results/sample/08_densify/points.zarr.zip").read_text())
    assert (cloud["inputs"]["stereo"] is not None) == matched_here
    assert cloud["names"] == {"cuda": asked}


def test_methods_of_the_segmentation_share_their_cuts(finished):
    """Contract: two cuts serve seven methods; those of pixels have masks and no mesh, and are measured without one.

    Matting serves one method. The surface alone is painted, and its pictures are compared with photographs.
    """
    cuts = {"gc_2d": "images", "gc_2d3d_pixel": "joint", "gc_2d3d_voxel": "joint", "sdf_2d3d_voxel": "joint"}
    cuts |= {"surface": "joint", "spectral_matting": "spectral"}
    alone = {"gc_2d", "gc_2d3d_pixel", "spectral_matting"}
    (finished.folder / "cuts.yaml").write_text(f"methods: [{', '.join(cuts)}, gc_select, volumetric_gc]\n")
    output = finished.run("--configfile", "cuts.yaml")
    expected = {"segment": 2, "volumetric_cut": 1, "cut_object": 4, "surface": 1, "pixel_masks": 3, "evaluate": 8}
    expected |= {"texture": 1, "photographs": 1, "spectral_matting": 1}
    assert jobs_done(output) == Counter({**expected, "collect": 1})
    results = finished.folder / "results/sample"
    for method, cut in cuts.items():
        made = json.loads((results / f"11_object/{method}/silhouettes.zarr.zip").read_text())
        labels = results / f"10_segment/{cut}.zarr.zip"
        assert made["inputs"]["labels"] == hashlib.sha256(labels.read_bytes()).hexdigest()
        assert (results / f"11_object/{method}/mesh.ply").exists() is (method not in alone)
        assert (results / f"11_object/{method}/mesh.glb").exists() is (method == "surface")
        assert (results / f"11_object/{method}/textured").exists() is (method == "surface")
    mesh, pictures = results / "11_object/surface/mesh.ply", results / "12_evaluate/surface/photographs.csv"
    made = json.loads((results / "11_object/surface/textured/000001.png").read_text())
    assert made["names"] == {"method": "surface"} and set(made["inputs"]) == {"mesh", "support", "keyframes", "crops"}
    assert made["inputs"]["mesh"] == hashlib.sha256(mesh.read_bytes()).hexdigest()
    assert pictures.read_text().splitlines()[1] == "photo_psnr,30,dB,sample,sample,surface,"
    assert " 30.0 |" in (finished.folder / "results/tables/meshes.md").read_text()
    with_field = json.loads((results / "11_object/sdf_2d3d_voxel/mesh.ply").read_text())
    assert with_field["inputs"]["field"] is not None
    (finished.folder / "deformed.yaml").write_text("methods: [gc_2d3d_pixel]\nsegment: {field: deformed}\n")
    done = jobs_done(finished.run("--configfile", "deformed.yaml"))
    assert done["deform"] == done["locate_object"] == done["segment"] == 1
    labels = json.loads((results / "10_segment/joint.zarr.zip").read_text())
    found = results / "07_fusion/located/deformed_sdf.zarr.zip"
    assert labels["inputs"]["located"] == hashlib.sha256(found.read_bytes()).hexdigest()


def test_variants_cut_again_with_their_settings_and_get_a_table(finished):
    """Contract: one that changes the cut has labels of its own; one of the mesh takes the configured ones."""
    (finished.folder / "variants.yaml").write_text(
        "methods: [fused_sdf, gc_2d3d_pixel, sdf_2d3d_voxel]\n"
        "variants: {no_table: {segment: {table: false}}, coarse: {cut_object: {dilation: 5}}}\n"
    )
    output = finished.run("--configfile", "variants.yaml")
    expected = {"segment": 2, "cut_object": 3, "pixel_masks": 3, "evaluate": 6, "collect": 1}
    # masks of pixels do not depend on how a mesh is cut: those of the second variant are those of none
    assert jobs_done(output) + jobs_taken(output) == Counter(expected), output
    results = finished.folder / "results/sample"
    plain, other = (
        json.loads((results / f"10_segment/joint{name}.zarr.zip").read_text()) for name in ("", "@no_table")
    )
    assert "table=True" in plain["params"] and "table=False" in other["params"]
    assert plain["names"] == other["names"] == {"cut": "joint"}
    for variant, cut in {"": "joint", "@no_table": "joint@no_table", "@coarse": "joint"}.items():
        made = json.loads((results / f"11_object/sdf_2d3d_voxel{variant}/mesh.ply").read_text())
        assert (
            made["inputs"]["labels"]
            == hashlib.sha256((results / f"10_segment/{cut}.zarr.zip").read_bytes()).hexdigest()
        )
        assert f"dilation={5 if variant == '@coarse' else 2}" in made["params"]
    table = (finished.folder / "results/tables/variants.md").read_text()
    assert table.count("| no_table ") == table.count("| coarse ") == 2
    assert "@" not in (finished.folder / "results/tables/iou.md").read_text()


def test_where_depth_needs_stereo_the_scene_is_matched_whole_and_crops_around_the_object(finished):
    (finished.folder / "wide.yaml").write_text("methods: [deformed_sdf]\nkeyframes: {stereo_angle: 0}\n")
    done = jobs_done(finished.run("--configfile", "wide.yaml"))
    assert done["stereo"] == done["stereo_check"] == done["depth"] == 4
    for scope, box_is_known in (("03_scene/", False), ("", True)):
        results = finished.folder / "results/sample" / scope
        patches, depth = (
            json.loads((results / f"{name}/000001.zarr.zip").read_text()) for name in ("05_stereo", "06_depth")
        )
        assert (patches["inputs"]["support"] is not None) == box_is_known
        assert depth["inputs"]["stereo"] is not None


def test_points_switched_off_need_no_stereo(finished):
    (finished.folder / "off.yaml").write_text("methods: [deformed_sdf]\ndensify: {points: off}\n")
    output = finished.run("--configfile", "off.yaml")
    assert jobs_done(output) == Counter(
        dict.fromkeys(("densify", "deform", "locate_object", "object", "evaluate", "collect"), 1)
    )
    cloud = json.loads((finished.folder / "results/sample/08_densify/points.zarr.zip").read_text())
    assert cloud["inputs"]["stereo"] is None


def test_depth_experiment_tries_keyframes_that_have_a_true_depth_and_joins_the_table(project):
    photos = project.folder / "photos"
    photos.mkdir()
    for name in ("000001.jpg", "000002.jpg", "000002.depth.png", "cameras.json"):
        (photos / name).write_text(name)
    truth = "{cameras: photos/cameras.json, depth: photos, depth_scale: 5000}"
    entry = f"{{source: photos, cameras: photos/cameras.json, object: false, truth: {truth}}}"
    (project.folder / "own.yaml").write_text(
        f"dataset: own\nsequences: {{mug: {entry}}}\ndepth_experiment: {{sequences: [mug]}}\n"
    )
    output = project.run("--configfile", "own.yaml")
    once = (
        "frames",
        "features",
        "poses",
        "keyframes",
        "crops",
        "depth_trial",
        "depth_experiment",
        "collect",
    )
    assert jobs_done(output) == Counter(once)
    crops = json.loads((project.folder / "results/mug/04_crops/keyframes.json").read_text())
    assert crops["inputs"]["support"] is None  # there is no object to find
    trial = json.loads((project.folder / "results/mug/12_depth_experiment/trials/000002.zarr.zip").read_text())
    assert trial["names"]["depth_scale"] == 5000 and trial["names"]["depth_settings"]["prior"] == "rotation_invariant"
    assert "own,mug,depth/all" in (project.folder / "results/metrics.csv").read_text()
    assert "Nothing to be done" in project.run("--configfile", "own.yaml")


def test_a_sequence_added_to_the_depth_experiment_leaves_the_trials_of_others(project):
    photos = project.folder / "photos"
    photos.mkdir()
    for name in ("000001.jpg", "000001.depth.png", "cameras.json"):
        (photos / name).write_text(name)
    files = "source: photos, cameras: photos/cameras.json, truth: {cameras: photos/cameras.json, depth: photos}"
    both = f"dataset: own\nsequences: {{mug: {{{files}}}, cup: {{{files}, calibration: photos}}}}\n"
    (project.folder / "own.yaml").write_text(both + "depth_experiment: {sequences: [mug]}\n")
    assert jobs_done(project.run("--configfile", "own.yaml"))["depth_trial"] == 1
    (project.folder / "own.yaml").write_text(both + "depth_experiment: {sequences: [mug, cup]}\n")
    output = project.run("--configfile", "own.yaml")
    assert jobs_done(output)["depth_trial"] == 1 and "Depth of mug" not in output


def test_killed_run_goes_on_to_the_same_bytes(finished):
    whole = finished.artifacts()
    shutil.rmtree(finished.folder / "results")
    process = subprocess.Popen(
        finished.command,
        cwd=finished.folder,
        env={**finished.forking, "STUB_PAUSE": "0.3"},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    scratch = finished.folder / "results/.store/scratch"
    wait_for(lambda: any(scratch.glob(".*/depth/*")), process)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    assert any(scratch.iterdir()), "the job was not in the middle of its work"
    output = finished.run()
    assert "poses" not in jobs_done(output) and jobs_done(output)["depth"] >= 1
    assert finished.artifacts() == whole
    remove_abandoned(scratch)  # as the next job does: the last one may have started before the killed one was gone
    assert not any(scratch.iterdir())


def test_a_folder_that_a_killed_run_left_half_filled_is_filled(project):
    """Stereo lies behind the checkpoint, where Snakemake does not look for what is half made."""
    (project.folder / "wide.yaml").write_text("keyframes: {stereo_angle: 0}\n")
    command = [*project.command, "--configfile", "wide.yaml"]
    stereo = project.folder / "results/sample/03_scene/05_stereo"
    with open(os.devnull, "w") as quiet:
        process = subprocess.Popen(
            command,
            cwd=project.folder,
            env={**project.environment, "STUB_PAUSE": "1"},
            stdout=quiet,
            stderr=quiet,
            start_new_session=True,
        )
    wait_for(stereo.is_dir, process)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    assert not list(stereo.glob("*.zarr.zip"))
    assert jobs_done(project.run("--configfile", "wide.yaml"))["stereo"] == 4  # two keyframes, in both passes


@pytest.mark.parametrize("old, new", [("{", "["), ('"needs_stereo": false', '"needs_stereo": 12345')])
def test_rules_plan_by_the_keyframes_that_were_written(finished, old, new):
    name = "sample/03_keyframes/keyframes.json"
    right, file = finished.artifacts(), finished.folder / "results" / name

    def damage():
        status = file.stat()
        file.write_text(right[name].decode().replace(old, new))
        os.utime(file, ns=(status.st_atime_ns, status.st_mtime_ns))
        shutil.rmtree(finished.folder / "results/sample/11_object")

    damage()
    output = finished.run()
    assert "stereo" not in jobs_done(output) + jobs_taken(output)
    assert {**finished.artifacts(), name: right[name]} == right
    damage()
    shutil.rmtree(finished.folder / "results/.store/objects")
    said = finished.run(good=False)
    assert f"{name}: expected the file that its job wrote" in said and "Traceback" not in said


def wait_for(condition, process, seconds=240):
    """Wait until a condition holds while a process runs."""
    end = time.monotonic() + seconds
    while not condition():
        assert process.poll() is None and time.monotonic() < end
        time.sleep(0.01)
