# 06: dense depth of a keyframe.


rule depth:
    input:
        undistorted="results/{sequence}/02_poses/undistorted.zarr.zip",
        keyframes="results/{sequence}/03_keyframes/keyframes.json",
        semidense="results/{sequence}/04_semidense",
        edges="results/{sequence}/05_edges",
        stereo=if_wide("results/{sequence}/05_stereo_checked"),
    output:
        depth=directory("results/{sequence}/06_depth"),
    log:
        "results/{sequence}/logs/depth.log",
    benchmark:
        "results/{sequence}/benchmarks/depth.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: KEYFRAMES_AT_ONCE
    resources:
        mem_mb=memory_of_keyframes(1500),
    params:
        stages=["depth"],
        code=code_of("depth"),
        settings=settings_of_each("depth"),
        seed=config["seed"],
    message:
        "Dense depth of {wildcards.sequence}."
    script:
        "../scripts/run_keyframes.py"
