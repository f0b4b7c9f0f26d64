# 11: the metric scale; only of sequences that name a tag, a board or a height.


rule scale:
    input:
        frames=to_measure(
            "results/{sequence}/01_frames/frames.zarr.zip", "tag", "board"
        ),
        poses=to_measure("results/{sequence}/02_poses/poses.json", "tag", "board"),
        mesh=to_measure("results/{sequence}/11_object/{method}/mesh.ply", "height"),
        support=to_measure("results/{sequence}/03_scene/support.json", "height"),
    output:
        scale="results/{sequence}/11_object/scale.json",
    log:
        "results/{sequence}/logs/scale.log",
    benchmark:
        "results/{sequence}/benchmarks/scale.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: 1
    resources:
        mem_mb=megabytes(1000),
        runtime=minutes(20),
    params:
        code=code_of("scale"),
        settings=settings_of("scale"),
        seed=config["seed"],
        labels=lambda wildcards: {"known": known_of(wildcards)},
    message:
        "Find the metric scale of {wildcards.sequence}."
    script:
        "../scripts/run_stage.py"
