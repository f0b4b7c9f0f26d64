# 07: find the plane and the object in the scene, then the object in each field on its own grid.


rule locate:
    input:
        scene="results/{sequence}/07_fusion/scene.zarr.zip",
        keyframes="results/{sequence}/03_keyframes/keyframes.json",
        points="results/{sequence}/02_poses/points.zarr.zip",
        semidense=per_keyframe("results/{sequence}/04_semidense/{keyframe}.zarr.zip"),
    output:
        support="results/{sequence}/07_fusion/support.json",
    log:
        "results/{sequence}/logs/locate.log",
    benchmark:
        "results/{sequence}/benchmarks/locate.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("locate", grid="fuse_scene"),
    params:
        code=code_of("locate"),
        settings=settings_of("locate"),
        seed=config["seed"],
        labels=lambda wildcards: {
            "clearance": settings_of("locate_object")(wildcards)["clearance"]
        },
    message:
        "Find the support plane and the object of {wildcards.sequence}."
    script:
        "../scripts/run_stage.py"


rule locate_object:
    input:
        volume=field_to_search,
        support="results/{sequence}/07_fusion/support.json",
        keyframes="results/{sequence}/03_keyframes/keyframes.json",
        semidense=per_keyframe("results/{sequence}/04_semidense/{keyframe}.zarr.zip"),
    output:
        located="results/{sequence}/07_fusion/located/{field}.zarr.zip",
    log:
        "results/{sequence}/logs/locate_object/{field}.log",
    benchmark:
        "results/{sequence}/benchmarks/locate_object/{field}.tsv"
    wildcard_constraints:
        field="|".join(FIELDS),
    conda:
        "../../envs/threedfs.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("locate_object"),
    params:
        code=code_of("locate_object"),
        settings=settings_of("locate_object"),
        seed=config["seed"],
    message:
        "Find the object of {wildcards.sequence} in {wildcards.field}."
    script:
        "../scripts/run_stage.py"
