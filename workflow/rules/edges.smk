# 05: edge strength of a keyframe.


rule edges:
    input:
        undistorted="results/{sequence}/02_poses/undistorted.zarr.zip",
        keyframes="results/{sequence}/03_keyframes/keyframes.json",
    output:
        edges="results/{sequence}/05_edges/{keyframe}.zarr.zip",
    log:
        "results/{sequence}/logs/edges/{keyframe}.log",
    benchmark:
        "results/{sequence}/benchmarks/edges/{keyframe}.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: 1
    resources:
        mem_mb=1000,
    params:
        code=code_of("edges"),
        settings=settings_of("edges"),
        seed=config["seed"],
    message:
        "Edges of {wildcards.sequence} {wildcards.keyframe}."
    script:
        "../scripts/run_stage.py"
