# 04: semi-dense inverse depth of a keyframe.


rule semidense:
    input:
        undistorted="results/{sequence}/02_poses/undistorted.zarr.zip",
        keyframes="results/{sequence}/03_keyframes/keyframes.json",
        poses="results/{sequence}/02_poses/poses.json",
        points="results/{sequence}/02_poses/points.zarr.zip",
    output:
        semidense="results/{sequence}/04_semidense/{keyframe}.zarr.zip",
    log:
        "results/{sequence}/logs/semidense/{keyframe}.log",
    benchmark:
        "results/{sequence}/benchmarks/semidense/{keyframe}.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: 1
    resources:
        mem_mb=1500,
    params:
        code=code_of("semidense"),
        settings=settings_of("semidense"),
        seed=config["seed"],
    message:
        "Semi-dense depth of {wildcards.sequence} {wildcards.keyframe}."
    script:
        "../scripts/run_stage.py"
