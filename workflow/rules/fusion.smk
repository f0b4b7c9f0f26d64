# 07: check the depth maps against each other, fuse them around the object.


rule consistency:
    input:
        keyframes="results/{sequence}/{scope}04_crops/keyframes.json",
        depth="results/{sequence}/{scope}06_depth",
    output:
        consistency="results/{sequence}/{scope}07_fusion/consistency.zarr.zip",
    log:
        "results/{sequence}/{scope}logs/consistency.log",
    benchmark:
        "results/{sequence}/{scope}benchmarks/consistency.tsv"
    priority: FIRST
    conda:
        "../../envs/threedfs.yaml"
    threads: THREADS
    resources:
        mem_mb=memory_of("consistency"),
        runtime=minutes(30),
    params:
        code=code_of("consistency"),
        settings=settings_of("consistency"),
        seed=config["seed"],
    message:
        "Check the depth maps of {wildcards.sequence} against each other."
    script:
        "../scripts/run_stage.py"


rule fuse_object:
    input:
        keyframes="results/{sequence}/04_crops/keyframes.json",
        depth="results/{sequence}/06_depth",
        consistency="results/{sequence}/07_fusion/consistency.zarr.zip",
        support="results/{sequence}/03_scene/support.json",
        scene="results/{sequence}/03_scene/volume.zarr.zip",
    output:
        volume="results/{sequence}/07_fusion/object.zarr.zip",
    log:
        "results/{sequence}/logs/fuse_object.log",
    benchmark:
        "results/{sequence}/benchmarks/fuse_object.tsv"
    priority: FIRST
    conda:
        "../../envs/threedfs.yaml"
    threads: THREADS
    resources:
        mem_mb=memory_of("fuse_object"),
        runtime=minutes(30),
    params:
        code=code_of("fuse_object"),
        settings=settings_of("fuse_object"),
        seed=config["seed"],
    message:
        "Fuse the object of {wildcards.sequence}."
    script:
        "../scripts/run_stage.py"


rule fuse_baseline:
    input:
        keyframes="results/{sequence}/04_crops/keyframes.json",
        depth="results/{sequence}/06_depth",
        support="results/{sequence}/03_scene/support.json",
    output:
        volume="results/{sequence}/07_fusion/baseline/{fusion}.zarr.zip",
    log:
        "results/{sequence}/logs/fuse_baseline/{fusion}.log",
    benchmark:
        "results/{sequence}/benchmarks/fuse_baseline/{fusion}.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: THREADS
    resources:
        mem_mb=memory_of("fuse_baseline", grid="fuse_baseline"),
        runtime=minutes(30),
    params:
        code=code_of("fuse_baseline"),
        settings=settings_of("fuse_baseline"),
        seed=config["seed"],
    message:
        "Fuse the object of {wildcards.sequence} by {wildcards.fusion}."
    script:
        "../scripts/run_stage.py"
