# 03: the one checkpoint; every list of keyframes comes from it.


checkpoint keyframes:
    input:
        frames="results/{sequence}/01_frames/frames.zarr.zip",
        poses="results/{sequence}/02_poses/poses.json",
        points="results/{sequence}/02_poses/points.zarr.zip",
        masks=given("keyframe_masks"),
    output:
        keyframes="results/{sequence}/03_keyframes/keyframes.json",
    log:
        "results/{sequence}/logs/keyframes.log",
    benchmark:
        "results/{sequence}/benchmarks/keyframes.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: 1
    resources:
        mem_mb=megabytes(1500),
        runtime=minutes(20),
    params:
        code=code_of("keyframes"),
        settings=settings_of("keyframes"),
        seed=config["seed"],
        content=fingerprint_of("keyframe_masks"),
    message:
        "Choose the keyframes of {wildcards.sequence}."
    script:
        "../scripts/run_stage.py"
