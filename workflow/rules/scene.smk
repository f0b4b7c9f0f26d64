# 03: the scene pass: small whole frames, looked at once to find the support plane and the object's box. Depth and
# consistency come from the rules that the pass on crops has too, by the wildcard `scope`.
SCOUTS = ["semidense", "edges"]


rule shrink:
    input:
        frames="results/{sequence}/01_frames/frames.zarr.zip",
        poses="results/{sequence}/02_poses/poses.json",
        keyframes="results/{sequence}/03_keyframes/keyframes.json",
    output:
        crops="results/{sequence}/03_scene/04_crops/crops.zarr.zip",
        views="results/{sequence}/03_scene/04_crops/keyframes.json",
    log:
        "results/{sequence}/logs/shrink.log",
    benchmark:
        "results/{sequence}/benchmarks/shrink.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: THREADS
    resources:
        mem_mb=megabytes(1500),
        runtime=minutes(20),
    params:
        code=code_of("shrink"),
        settings=settings_of("shrink"),
        seed=config["seed"],
    message:
        "Small frames of {wildcards.sequence}."
    script:
        "../scripts/run_stage.py"


rule scout:
    input:
        crops="results/{sequence}/03_scene/04_crops/crops.zarr.zip",
        keyframes="results/{sequence}/03_scene/04_crops/keyframes.json",
        poses="results/{sequence}/02_poses/poses.json",
        points="results/{sequence}/02_poses/points.zarr.zip",
    output:
        semidense=directory("results/{sequence}/03_scene/04_semidense"),
        edges=directory("results/{sequence}/03_scene/05_edges"),
    log:
        "results/{sequence}/logs/scout.log",
    benchmark:
        "results/{sequence}/benchmarks/scout.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: KEYFRAMES_AT_ONCE
    resources:
        mem_mb=memory_of_keyframes("scout"),
        runtime=minutes(10, each=0.5),
    params:
        stages=SCOUTS,
        code=[code_of(stage) for stage in SCOUTS],
        settings=settings_of_each(*SCOUTS),
        seed=config["seed"],
    message:
        "Semi-dense depth and edges of small frames of {wildcards.sequence}."
    script:
        "../scripts/run_keyframes.py"


rule fuse_scene:
    input:
        keyframes="results/{sequence}/03_scene/04_crops/keyframes.json",
        points="results/{sequence}/02_poses/points.zarr.zip",
        depth="results/{sequence}/03_scene/06_depth",
        consistency="results/{sequence}/03_scene/07_fusion/consistency.zarr.zip",
    output:
        scene="results/{sequence}/03_scene/volume.zarr.zip",
    log:
        "results/{sequence}/logs/fuse_scene.log",
    benchmark:
        "results/{sequence}/benchmarks/fuse_scene.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: THREADS
    resources:
        mem_mb=memory_of("fuse_scene", grid="fuse_scene"),
        runtime=minutes(30),
    params:
        code=code_of("fuse_scene"),
        settings=settings_of("fuse_scene"),
        seed=config["seed"],
    message:
        "Fuse the scene of {wildcards.sequence}."
    script:
        "../scripts/run_stage.py"


rule locate:
    input:
        scene="results/{sequence}/03_scene/volume.zarr.zip",
        keyframes="results/{sequence}/03_scene/04_crops/keyframes.json",
        points="results/{sequence}/02_poses/points.zarr.zip",
        crops="results/{sequence}/03_scene/04_crops/crops.zarr.zip",
        semidense="results/{sequence}/03_scene/04_semidense",
        edges="results/{sequence}/03_scene/05_edges",
        depth="results/{sequence}/03_scene/06_depth",
        consistency="results/{sequence}/03_scene/07_fusion/consistency.zarr.zip",
    output:
        support="results/{sequence}/03_scene/support.json",
    log:
        "results/{sequence}/logs/locate.log",
    benchmark:
        "results/{sequence}/benchmarks/locate.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: THREADS
    resources:
        mem_mb=memory_of("locate", grid="fuse_scene"),
        runtime=minutes(30),
    params:
        code=code_of("locate"),
        settings=settings_of("locate"),
        seed=config["seed"],
        labels=lambda wildcards: {
            "clearance": settings_of("locate_object")(wildcards)["clearance"],
            "segmentation": settings_of("segment")(wildcards),
        },
    message:
        "Find the support plane and the object of {wildcards.sequence}."
    script:
        "../scripts/run_stage.py"
