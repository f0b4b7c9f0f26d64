# 08: oriented points on the surface of the object.


rule densify:
    input:
        crops="results/{sequence}/04_crops/crops.zarr.zip",
        keyframes="results/{sequence}/04_crops/keyframes.json",
        poses="results/{sequence}/02_poses/poses.json",
        points="results/{sequence}/02_poses/points.zarr.zip",
        support="results/{sequence}/03_scene/support.json",
        stereo=if_matched_here("results/{sequence}/05_stereo"),
    output:
        cloud="results/{sequence}/08_densify/points.zarr.zip",
    log:
        "results/{sequence}/logs/densify.log",
    benchmark:
        "results/{sequence}/benchmarks/densify.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: 1
    resources:
        mem_mb=megabytes(3000),
        runtime=minutes(120),
    params:
        code=code_of("densify"),
        settings=settings_of("densify"),
        seed=config["seed"],
        labels=lambda wildcards: {"cuda": finds_cuda(wildcards)},
    message:
        "Find surface points of {wildcards.sequence}."
    script:
        "../scripts/run_stage.py"
