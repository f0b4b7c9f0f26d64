# 12: the paper's depth experiment: three priors and interpolation, from depths drawn from the ground truth.
TRIALS = ["edges", "depth_trial"]


rule depth_trial:
    input:
        frames="results/{sequence}/01_frames/frames.zarr.zip",
        crops="results/{sequence}/04_crops/crops.zarr.zip",
        keyframes="results/{sequence}/04_crops/keyframes.json",
        poses="results/{sequence}/02_poses/poses.json",
        masks_truth=given("truth_masks"),
        cameras_truth=given("truth_cameras"),
        mesh_truth=given("truth_mesh"),
        depth_truth=given("truth_depth"),
    output:
        edges=directory("results/{sequence}/12_depth_experiment/edges"),
        trial=directory("results/{sequence}/12_depth_experiment/trials"),
    log:
        "results/{sequence}/logs/depth_trial.log",
    benchmark:
        "results/{sequence}/benchmarks/depth_trial.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: KEYFRAMES_AT_ONCE
    resources:
        mem_mb=memory_of_keyframes("depth_trial"),
        runtime=minutes(20, each=4),
    params:
        stages=TRIALS,
        code=[code_of(stage) for stage in TRIALS],
        settings=settings_of_each(*TRIALS),
        seed=config["seed"],
        trials=count_trials,  # the keyframes follow from inputs: Snakemake does not watch them
        keyframes=choose_trials,
        content=fingerprint_of(
            "truth_masks", "truth_cameras", "truth_mesh", "truth_depth"
        ),
        labels=lambda wildcards: {
            "depth_settings": settings_of("depth")(wildcards),
            "depth_scale": SEQUENCES[wildcards.sequence]["depth_scale"],
            "depth_camera": SEQUENCES[wildcards.sequence]["depth_camera"],
            "intrinsics": SEQUENCES[wildcards.sequence]["intrinsics"],
        },
    message:
        "Depth of {wildcards.sequence} by every prior."
    script:
        "../scripts/run_keyframes.py"


rule depth_experiment:
    input:
        trials="results/{sequence}/12_depth_experiment/trials",
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
        mem_mb=megabytes(1000),
        runtime=minutes(20),
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
