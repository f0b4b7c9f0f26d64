# 05: slanted patches of a keyframe that match in other views: of the whole image where depth needs them, else of the
# pixels that see the object's box.


rule stereo:
    input:
        undistorted="results/{sequence}/02_poses/undistorted.zarr.zip",
        keyframes="results/{sequence}/03_keyframes/keyframes.json",
        semidense="results/{sequence}/04_semidense",
        support=unless_wide("results/{sequence}/07_fusion/support.json"),
    output:
        stereo=directory("results/{sequence}/05_stereo"),
    log:
        "results/{sequence}/logs/stereo.log",
    benchmark:
        "results/{sequence}/benchmarks/stereo.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: KEYFRAMES_AT_ONCE
    resources:
        mem_mb=memory_of_keyframes(1000),
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
        keyframes="results/{sequence}/03_keyframes/keyframes.json",
        stereo="results/{sequence}/05_stereo",
    output:
        checked=directory("results/{sequence}/05_stereo_checked"),
    log:
        "results/{sequence}/logs/stereo_check.log",
    benchmark:
        "results/{sequence}/benchmarks/stereo_check.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: KEYFRAMES_AT_ONCE
    resources:
        mem_mb=memory_of_keyframes(1000),
    params:
        stages=["stereo_check"],
        code=code_of("stereo_check"),
        settings=settings_of_each("stereo_check"),
        seed=config["seed"],
    message:
        "Check the patches of {wildcards.sequence}."
    script:
        "../scripts/run_keyframes.py"
