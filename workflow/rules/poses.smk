# 02: keypoints, camera of every frame, sparse points.


rule features:
    input:
        frames="results/{sequence}/01_frames/frames.zarr.zip",
    output:
        features="results/{sequence}/02_poses/features.zarr.zip",
    log:
        "results/{sequence}/logs/features.log",
    benchmark:
        "results/{sequence}/benchmarks/features.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: THREADS
    resources:
        mem_mb=megabytes(2000),
        runtime=minutes(30),
    params:
        code=code_of("features"),
        settings=settings_of("features"),
        seed=config["seed"],
    message:
        "Find the keypoints of {wildcards.sequence}."
    script:
        "../scripts/run_stage.py"


rule poses:
    input:
        frames="results/{sequence}/01_frames/frames.zarr.zip",
        features="results/{sequence}/02_poses/features.zarr.zip",
        cameras=given("cameras"),
        calibration=branch(
            lambda wildcards: SEQUENCES[wildcards.sequence]["calibration"] is not None,
            then="results/{sequence}/01_frames/calibration.json",
            otherwise=[],
        ),
    output:
        poses="results/{sequence}/02_poses/poses.json",
        points="results/{sequence}/02_poses/points.zarr.zip",
    log:
        "results/{sequence}/logs/poses.log",
    benchmark:
        "results/{sequence}/benchmarks/poses.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: THREADS
    resources:
        mem_mb=megabytes(3000),
        runtime=minutes(60),
    params:
        code=code_of("poses"),
        settings=settings_of("poses"),
        seed=config["seed"],
        content=fingerprint_of("cameras"),
        labels=lambda wildcards: {
            # those that true cameras may have change nothing here
            "intrinsics": (
                SEQUENCES[wildcards.sequence]["intrinsics"]
                if SEQUENCES[wildcards.sequence]["cameras"]
                else None
            )
        },
    message:
        "Find the cameras of {wildcards.sequence}."
    script:
        "../scripts/run_stage.py"
