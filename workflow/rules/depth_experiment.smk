# 12: the paper's depth experiment: three priors and interpolation, from depths drawn from the ground truth.
from threedfs.io.truth_files import choose_with_depth


rule depth_trial:
    input:
        undistorted="results/{sequence}/02_poses/undistorted.zarr.zip",
        keyframes="results/{sequence}/03_keyframes/keyframes.json",
        edges="results/{sequence}/05_edges/{keyframe}.zarr.zip",
        poses="results/{sequence}/02_poses/poses.json",
        masks_truth=given("truth_masks"),
        cameras_truth=given("truth_cameras"),
        mesh_truth=given("truth_mesh"),
        depth_truth=given("truth_depth"),
    output:
        trial="results/{sequence}/12_depth_experiment/{keyframe}.zarr.zip",
    log:
        "results/{sequence}/logs/depth_trial/{keyframe}.log",
    benchmark:
        "results/{sequence}/benchmarks/depth_trial/{keyframe}.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: 1
    resources:
        mem_mb=1500,
    params:
        code=code_of("depth_trial"),
        settings=settings_of("depth_trial"),
        seed=config["seed"],
        folders=fingerprint_of("truth_masks", "truth_cameras", "truth_depth"),
        labels=lambda wildcards: {
            "depth_settings": settings_of("depth")(wildcards),
            "depth_scale": SEQUENCES[wildcards.sequence]["depth_scale"],
            "depth_camera": SEQUENCES[wildcards.sequence]["depth_camera"],
            "intrinsics": SEQUENCES[wildcards.sequence]["intrinsics"],
        },
    message:
        "Depth of {wildcards.sequence} {wildcards.keyframe} by every prior."
    script:
        "../scripts/run_stage.py"


rule depth_experiment:
    input:
        trials=per_keyframe(
            "results/{sequence}/12_depth_experiment/{keyframe}.zarr.zip",
            choose=lambda names, wildcards: choose_with_depth(
                names,
                SEQUENCES[wildcards.sequence]["truth_depth"],
                settings_of("depth_experiment")(wildcards)["keyframes"],
            ),
        ),
    output:
        metrics="results/{sequence}/12_depth_experiment/metrics.csv",
    log:
        "results/{sequence}/logs/depth_experiment.log",
    benchmark:
        "results/{sequence}/benchmarks/depth_experiment.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: 1
    resources:
        mem_mb=1000,
    params:
        code=code_of("depth_experiment"),
        settings=settings_of("depth_experiment"),
        seed=config["seed"],
        labels=lambda wildcards: {
            "dataset": SEQUENCES[wildcards.sequence]["dataset"],
            "sequence": wildcards.sequence,
        },
    message:
        "Score the depth experiment of {wildcards.sequence}."
    script:
        "../scripts/run_stage.py"
