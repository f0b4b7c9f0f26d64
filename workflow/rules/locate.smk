# 07: the object in each field on its own grid, found once for all that follows.


rule locate_object:
    input:
        volume=field_to_search,
        support="results/{sequence}/03_scene/support.json",
        keyframes="results/{sequence}/04_crops/keyframes.json",
        semidense="results/{sequence}/04_semidense",
    output:
        located="results/{sequence}/07_fusion/located/{field}.zarr.zip",
    log:
        "results/{sequence}/logs/locate_object/{field}.log",
    benchmark:
        "results/{sequence}/benchmarks/locate_object/{field}.tsv"
    wildcard_constraints:
        field="|".join(FIELDS),
    priority: FIRST
    conda:
        "../../envs/threedfs.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("locate_object"),
        runtime=minutes(20),
    params:
        code=code_of("locate_object"),
        settings=settings_of("locate_object"),
        seed=config["seed"],
    message:
        "Find the object of {wildcards.sequence} in {wildcards.field}."
    script:
        "../scripts/run_stage.py"
