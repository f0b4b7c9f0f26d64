# 10: one labelling of superpixels and voxels, and its baselines.


rule superpixels:
    input:
        undistorted="results/{sequence}/02_poses/undistorted.zarr.zip",
        keyframes="results/{sequence}/03_keyframes/keyframes.json",
        edges="results/{sequence}/05_edges/{keyframe}.zarr.zip",
    output:
        superpixels="results/{sequence}/10_segment/superpixels/{keyframe}.zarr.zip",
    log:
        "results/{sequence}/logs/superpixels/{keyframe}.log",
    benchmark:
        "results/{sequence}/benchmarks/superpixels/{keyframe}.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: 1
    resources:
        mem_mb=1000,
    params:
        code=code_of("superpixels"),
        settings=settings_of("superpixels"),
        seed=config["seed"],
    message:
        "Superpixels of {wildcards.sequence} {wildcards.keyframe}."
    script:
        "../scripts/run_stage.py"


rule segment:
    input:
        field=field_to_segment,
        located=located_to_segment,
        support="results/{sequence}/07_fusion/support.json",
        keyframes="results/{sequence}/03_keyframes/keyframes.json",
        undistorted="results/{sequence}/02_poses/undistorted.zarr.zip",
        superpixels=per_keyframe(
            "results/{sequence}/10_segment/superpixels/{keyframe}.zarr.zip"
        ),
        semidense=per_keyframe("results/{sequence}/04_semidense/{keyframe}.zarr.zip"),
        depth=per_keyframe("results/{sequence}/06_depth/{keyframe}.zarr.zip"),
        consistency="results/{sequence}/07_fusion/consistency.zarr.zip",
    output:
        labels="results/{sequence}/10_segment/{cut}{variant}.zarr.zip",
    log:
        "results/{sequence}/logs/segment/{cut}{variant}.log",
    benchmark:
        "results/{sequence}/benchmarks/segment/{cut}{variant}.tsv"
    wildcard_constraints:
        cut="joint|images",
    conda:
        "../../envs/threedfs.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("segment"),
    params:
        code=code_of("segment"),
        settings=settings_of("segment"),
        seed=config["seed"],
    message:
        "Segment {wildcards.sequence}: {wildcards.cut}{wildcards.variant}."
    script:
        "../scripts/run_stage.py"


rule volumetric_cut:
    input:
        support="results/{sequence}/07_fusion/support.json",
        keyframes="results/{sequence}/03_keyframes/keyframes.json",
        undistorted="results/{sequence}/02_poses/undistorted.zarr.zip",
        semidense=per_keyframe("results/{sequence}/04_semidense/{keyframe}.zarr.zip"),
    output:
        labels="results/{sequence}/10_segment/volumetric.zarr.zip",
    log:
        "results/{sequence}/logs/volumetric_cut.log",
    benchmark:
        "results/{sequence}/benchmarks/volumetric_cut.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("volumetric_cut"),
    params:
        code=code_of("volumetric_cut"),
        settings=settings_of("volumetric_cut"),
        seed=config["seed"],
    message:
        "Cut the voxels of {wildcards.sequence} by colour."
    script:
        "../scripts/run_stage.py"
