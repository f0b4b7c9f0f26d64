# 05: slanted patches of a keyframe that match in other views: of the whole image where depth needs them, else of the
# pixels that see the object's box.


rule stereo:
    input:
        undistorted="results/{sequence}/02_poses/undistorted.zarr.zip",
        keyframes="results/{sequence}/03_keyframes/keyframes.json",
        semidense="results/{sequence}/04_semidense/{keyframe}.zarr.zip",
        support=unless_wide("results/{sequence}/07_fusion/support.json"),
    output:
        stereo="results/{sequence}/05_stereo/{keyframe}.zarr.zip",
    log:
        "results/{sequence}/logs/stereo/{keyframe}.log",
    benchmark:
        "results/{sequence}/benchmarks/stereo/{keyframe}.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: 1
    resources:
        mem_mb=1000,
    params:
        code=code_of("stereo"),
        settings=settings_of("stereo"),
        seed=config["seed"],
    message:
        "Match patches of {wildcards.sequence} {wildcards.keyframe}."
    script:
        "../scripts/run_stage.py"


rule stereo_check:
    input:
        keyframes="results/{sequence}/03_keyframes/keyframes.json",
        stereo=per_keyframe("results/{sequence}/05_stereo/{keyframe}.zarr.zip"),
    output:
        checked="results/{sequence}/05_stereo/checked/{keyframe}.zarr.zip",
    log:
        "results/{sequence}/logs/stereo_check/{keyframe}.log",
    benchmark:
        "results/{sequence}/benchmarks/stereo_check/{keyframe}.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: 1
    resources:
        mem_mb=1000,
    params:
        code=code_of("stereo_check"),
        settings=settings_of("stereo_check"),
        seed=config["seed"],
    message:
        "Check the patches of {wildcards.sequence} {wildcards.keyframe}."
    script:
        "../scripts/run_stage.py"
