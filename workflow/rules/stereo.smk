# 05: slanted patches of a keyframe that match in other views: of the pixels that see the object's box, once it is known.


rule stereo:
    input:
        crops="results/{sequence}/{scope}04_crops/crops.zarr.zip",
        keyframes="results/{sequence}/{scope}04_crops/keyframes.json",
        semidense="results/{sequence}/{scope}04_semidense",
        support=box_of_scope,
    output:
        stereo=directory("results/{sequence}/{scope}05_stereo"),
    log:
        "results/{sequence}/{scope}logs/stereo.log",
    benchmark:
        "results/{sequence}/{scope}benchmarks/stereo.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: KEYFRAMES_AT_ONCE
    resources:
        mem_mb=memory_of_keyframes("stereo"),
        runtime=minutes(20, each=1.5),
    params:
        stages=["stereo"],
        code=code_of("stereo"),
        settings=settings_of_each("stereo"),
        seed=config["seed"],
    message:
        "Match patches of {wildcards.sequence}."
    script:
        "../scripts/run_keyframes.py"


rule stereo_check:
    input:
        keyframes="results/{sequence}/{scope}04_crops/keyframes.json",
        stereo="results/{sequence}/{scope}05_stereo",
    output:
        checked=directory("results/{sequence}/{scope}05_stereo_checked"),
    log:
        "results/{sequence}/{scope}logs/stereo_check.log",
    benchmark:
        "results/{sequence}/{scope}benchmarks/stereo_check.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: KEYFRAMES_AT_ONCE
    resources:
        mem_mb=memory_of_keyframes("stereo_check"),
        runtime=minutes(10, each=0.5),
    params:
        stages=["stereo_check"],
        code=code_of("stereo_check"),
        settings=settings_of_each("stereo_check"),
        seed=config["seed"],
    message:
        "Check the patches of {wildcards.sequence}."
    script:
        "../scripts/run_keyframes.py"
