# 04: crops of the source around the object; whole frames where there is none.


rule crops:
    input:
        source=given("source"),
        poses="results/{sequence}/02_poses/poses.json",
        points="results/{sequence}/02_poses/points.zarr.zip",
        keyframes="results/{sequence}/03_keyframes/keyframes.json",
        support=branch(
            lambda wildcards: wildcards.sequence in OBJECTS,
            then="results/{sequence}/03_scene/support.json",
            otherwise=[],
        ),
    output:
        crops="results/{sequence}/04_crops/crops.zarr.zip",
        views="results/{sequence}/04_crops/keyframes.json",
    log:
        "results/{sequence}/logs/crops.log",
    benchmark:
        "results/{sequence}/benchmarks/crops.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: THREADS
    resources:
        mem_mb=megabytes(1500),
        runtime=minutes(30),
    params:
        code=code_of("crops"),
        settings=settings_of("crops"),
        seed=config["seed"],
        content=fingerprint_of("source"),
        labels=lambda wildcards: {
            "frame_far_factor": settings_of("keyframes")(wildcards)["far_factor"]
        },
    message:
        "Cut the crops of {wildcards.sequence}."
    script:
        "../scripts/run_stage.py"
