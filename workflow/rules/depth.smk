# 06: dense depth of a keyframe.


rule depth:
    input:
        crops="results/{sequence}/{scope}04_crops/crops.zarr.zip",
        keyframes="results/{sequence}/{scope}04_crops/keyframes.json",
        semidense="results/{sequence}/{scope}04_semidense",
        edges="results/{sequence}/{scope}05_edges",
        stereo=if_wide("results/{sequence}/{scope}05_stereo_checked"),
    output:
        depth=directory("results/{sequence}/{scope}06_depth"),
    log:
        "results/{sequence}/{scope}logs/depth.log",
    benchmark:
        "results/{sequence}/{scope}benchmarks/depth.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: KEYFRAMES_AT_ONCE
    resources:
        mem_mb=memory_of_keyframes("depth"),
        runtime=minutes(20, each=1),
    params:
        stages=["depth"],
        code=code_of("depth"),
        settings=settings_of_each("depth"),
        seed=config["seed"],
    message:
        "Dense depth of {wildcards.sequence}."
    script:
        "../scripts/run_keyframes.py"
