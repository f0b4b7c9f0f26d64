# 04, 05, 10: what the images show by themselves at every keyframe: semi-dense inverse depth, edge strength, superpixels.
CUES = ["semidense", "edges", "superpixels"]


rule cues:
    input:
        crops="results/{sequence}/04_crops/crops.zarr.zip",
        keyframes="results/{sequence}/04_crops/keyframes.json",
        poses="results/{sequence}/02_poses/poses.json",
        points="results/{sequence}/02_poses/points.zarr.zip",
    output:
        semidense=directory("results/{sequence}/04_semidense"),
        edges=directory("results/{sequence}/05_edges"),
        superpixels=directory("results/{sequence}/10_segment/superpixels"),
    log:
        "results/{sequence}/logs/cues.log",
    benchmark:
        "results/{sequence}/benchmarks/cues.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: KEYFRAMES_AT_ONCE
    resources:
        mem_mb=memory_of_keyframes("cues"),
        runtime=minutes(20, each=1),
    params:
        stages=CUES,
        code=[code_of(stage) for stage in CUES],
        settings=settings_of_each(*CUES),
        seed=config["seed"],
    message:
        "Semi-dense depth, edges and superpixels of {wildcards.sequence}."
    script:
        "../scripts/run_keyframes.py"
