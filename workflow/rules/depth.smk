# 06: dense depth of a keyframe.


rule depth:
    input:
        undistorted="results/{sequence}/02_poses/undistorted.zarr.zip",
        keyframes="results/{sequence}/03_keyframes/keyframes.json",
        semidense="results/{sequence}/04_semidense/{keyframe}.zarr.zip",
        edges="results/{sequence}/05_edges/{keyframe}.zarr.zip",
        stereo=if_wide("results/{sequence}/05_stereo/checked/{keyframe}.zarr.zip"),
    output:
        depth="results/{sequence}/06_depth/{keyframe}.zarr.zip",
    log:
        "results/{sequence}/logs/depth/{keyframe}.log",
    benchmark:
        "results/{sequence}/benchmarks/depth/{keyframe}.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: 1
    resources:
        mem_mb=1500,
    params:
        code=code_of("depth"),
        settings=settings_of("depth"),
        seed=config["seed"],
    message:
        "Dense depth of {wildcards.sequence} {wildcards.keyframe}."
    script:
        "../scripts/run_stage.py"
