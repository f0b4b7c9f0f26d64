# 10: one labelling of superpixels and voxels, and its baselines.


rule segment:
    input:
        field=field_to_segment,
        located=located_to_segment,
        support="results/{sequence}/03_scene/support.json",
        keyframes="results/{sequence}/04_crops/keyframes.json",
        crops="results/{sequence}/04_crops/crops.zarr.zip",
        superpixels="results/{sequence}/10_segment/superpixels",
        semidense="results/{sequence}/04_semidense",
        depth="results/{sequence}/06_depth",
        consistency="results/{sequence}/07_fusion/consistency.zarr.zip",
    output:
        labels="results/{sequence}/10_segment/{cut}{variant}.zarr.zip",
        appearance="results/{sequence}/10_segment/appearance/{cut}{variant}.zarr.zip",
    log:
        "results/{sequence}/logs/segment/{cut}{variant}.log",
    benchmark:
        "results/{sequence}/benchmarks/segment/{cut}{variant}.tsv"
    wildcard_constraints:
        cut="joint|images",
    priority: FIRST
    conda:
        "../../envs/threedfs.yaml"
    threads: THREADS
    resources:
        mem_mb=memory_of("segment"),
        runtime=minutes(30),
    params:
        code=code_of("segment"),
        settings=settings_of("segment"),
        seed=config["seed"],
    message:
        "Segment {wildcards.sequence}: {wildcards.cut}{wildcards.variant}."
    script:
        "../scripts/run_stage.py"


rule spectral_matting:
    input:
        field=field_to_segment,
        located=located_to_segment,
        keyframes="results/{sequence}/04_crops/keyframes.json",
        crops="results/{sequence}/04_crops/crops.zarr.zip",
    output:
        labels="results/{sequence}/10_segment/spectral.zarr.zip",
    log:
        "results/{sequence}/logs/spectral_matting.log",
    benchmark:
        "results/{sequence}/benchmarks/spectral_matting.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: 1
    resources:
        mem_mb=memory_of_matting,
        runtime=minutes(20, each=2),
    params:
        code=code_of("spectral_matting"),
        settings=settings_of("spectral_matting"),
        seed=config["seed"],
        labels=lambda wildcards: {"segmentation": settings_of("segment")(wildcards)},
    message:
        "Matte the keyframes of {wildcards.sequence}, one by one."
    script:
        "../scripts/run_stage.py"


rule volumetric_cut:
    input:
        support="results/{sequence}/03_scene/support.json",
        keyframes="results/{sequence}/04_crops/keyframes.json",
        crops="results/{sequence}/04_crops/crops.zarr.zip",
        semidense="results/{sequence}/04_semidense",
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
        mem_mb=memory_of("volumetric_cut", grid="volumetric_cut"),
        runtime=minutes(60),
    params:
        code=code_of("volumetric_cut"),
        settings=settings_of("volumetric_cut"),
        seed=config["seed"],
    message:
        "Cut the voxels of {wildcards.sequence} by colour."
    script:
        "../scripts/run_stage.py"
