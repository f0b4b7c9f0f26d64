# 12: measure against the ground truth, where there is any: what all methods share, then each method's mesh and masks.


rule evaluate_reconstruction:
    input:
        poses="results/{sequence}/02_poses/poses.json",
        keyframes="results/{sequence}/04_crops/keyframes.json",
        depth="results/{sequence}/06_depth",
        frames="results/{sequence}/01_frames/frames.zarr.zip",
        cameras_truth=given("truth_cameras"),
        mesh_truth=given("truth_mesh"),
        depth_truth=given("truth_depth"),
    output:
        metrics="results/{sequence}/12_evaluate/reconstruction.csv",
    log:
        "results/{sequence}/logs/evaluate_reconstruction.log",
    benchmark:
        "results/{sequence}/benchmarks/evaluate_reconstruction.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: 1
    resources:
        mem_mb=megabytes(2000),
        runtime=minutes(30),
    params:
        code=code_of("evaluate_reconstruction"),
        settings=settings_of("evaluate_reconstruction"),
        seed=config["seed"],
        content=fingerprint_of("truth_cameras", "truth_mesh", "truth_depth"),
        labels=lambda wildcards: {
            "dataset": SEQUENCES[wildcards.sequence]["dataset"],
            "sequence": wildcards.sequence,
            "intrinsics": SEQUENCES[wildcards.sequence]["intrinsics"],
            "depth_scale": SEQUENCES[wildcards.sequence]["depth_scale"],
            "depth_camera": SEQUENCES[wildcards.sequence]["depth_camera"],
        },
    message:
        "Measure poses and depth of {wildcards.sequence}."
    script:
        "../scripts/run_stage.py"


rule evaluate:
    input:
        poses="results/{sequence}/02_poses/poses.json",
        keyframes="results/{sequence}/03_keyframes/keyframes.json",
        mesh=mesh_of_method,
        masks="results/{sequence}/11_object/{method}/masks",
        silhouettes="results/{sequence}/11_object/{method}/silhouettes.zarr.zip",
        crops="results/{sequence}/04_crops/keyframes.json",
        frames="results/{sequence}/01_frames/frames.zarr.zip",
        masks_truth=given("truth_masks"),
        cameras_truth=given("truth_cameras"),
        mesh_truth=given("truth_mesh"),
    output:
        metrics="results/{sequence}/12_evaluate/{method}/metrics.csv",
    log:
        "results/{sequence}/logs/evaluate/{method}.log",
    benchmark:
        "results/{sequence}/benchmarks/evaluate/{method}.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: 1
    resources:
        mem_mb=megabytes(2000),
        runtime=minutes(30),
    params:
        code=code_of("evaluate"),
        settings=settings_of("evaluate"),
        seed=config["seed"],
        content=fingerprint_of("truth_masks", "truth_cameras", "truth_mesh"),
        labels=lambda wildcards: {
            "dataset": SEQUENCES[wildcards.sequence]["dataset"],
            "sequence": wildcards.sequence,
            "intrinsics": SEQUENCES[wildcards.sequence]["intrinsics"],
        },
    message:
        "Measure {wildcards.sequence} by {wildcards.method}."
    script:
        "../scripts/run_stage.py"


rule photographs:
    input:
        mesh="results/{sequence}/11_object/{method}/mesh.ply",
        textured="results/{sequence}/11_object/{method}/textured",
        keyframes="results/{sequence}/04_crops/keyframes.json",
        crops="results/{sequence}/04_crops/crops.zarr.zip",
    output:
        metrics="results/{sequence}/12_evaluate/{method}/photographs.csv",
    log:
        "results/{sequence}/logs/photographs/{method}.log",
    benchmark:
        "results/{sequence}/benchmarks/photographs/{method}.tsv"
    priority: FIRST
    conda:
        "../../envs/threedfs.yaml"
    threads: 1
    resources:
        mem_mb=megabytes(1500),
        runtime=minutes(20),
    params:
        code=code_of("photographs"),
        settings=settings_of("photographs"),
        seed=config["seed"],
        labels=lambda wildcards: {
            "dataset": SEQUENCES[wildcards.sequence]["dataset"],
            "sequence": wildcards.sequence,
        },
    message:
        "Photograph {wildcards.sequence} by {wildcards.method}."
    script:
        "../scripts/run_stage.py"


rule collect:
    input:
        tables=[
            *expand(
                "results/{sequence}/12_evaluate/reconstruction.csv", sequence=OBJECTS
            ),
            *expand(
                "results/{sequence}/12_evaluate/{method}/metrics.csv",
                sequence=OBJECTS,
                method=METHODS,
            ),
            *expand(
                "results/{sequence}/12_evaluate/{method}/photographs.csv",
                sequence=OBJECTS,
                method=PAINTED,
            ),
            *expand(
                "results/{sequence}/12_depth_experiment/metrics.csv", sequence=TRIED
            ),
        ],
    output:
        metrics="results/tables/metrics.csv",
    log:
        "results/logs/collect.log",
    benchmark:
        "results/benchmarks/collect.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: 1
    resources:
        mem_mb=megabytes(500),
        runtime=minutes(20),
    params:
        code=code_of("collect"),
        settings=settings_of("collect"),
        seed=config["seed"],
    message:
        "Collect the figures of the run."
    script:
        "../scripts/run_stage.py"
