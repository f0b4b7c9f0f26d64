# 09: the zero level of the object's field, moved onto its surface points.


rule deform:
    input:
        field="results/{sequence}/07_fusion/object.zarr.zip",
        support="results/{sequence}/03_scene/support.json",
        cloud="results/{sequence}/08_densify/points.zarr.zip",
    output:
        volume="results/{sequence}/09_deform/volume.zarr.zip",
    log:
        "results/{sequence}/logs/deform.log",
    benchmark:
        "results/{sequence}/benchmarks/deform.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: THREADS
    resources:
        mem_mb=memory_of("deform", unknowns=unknowns_of_correction),
        runtime=minutes(60),
    params:
        code=code_of("deform"),
        settings=settings_of("deform"),
        seed=config["seed"],
        labels=lambda wildcards: {
            name: settings_of("locate_object")(wildcards)[name]
            for name in ("clearance", "noise_clearance")
        },
    message:
        "Correct the zero level of {wildcards.sequence}."
    script:
        "../scripts/run_stage.py"
