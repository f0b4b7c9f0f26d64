# 01: decode the source into working frames; the camera's calibration, if there are photos for it.


rule calibrate:
    input:
        boards=given("calibration"),
    output:
        calibration="results/{sequence}/01_frames/calibration.json",
    log:
        "results/{sequence}/logs/calibrate.log",
    benchmark:
        "results/{sequence}/benchmarks/calibrate.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: 1
    resources:
        mem_mb=megabytes(1500),
        runtime=minutes(30),
    params:
        code=code_of("calibrate"),
        settings=settings_of("calibrate"),
        seed=config["seed"],
        content=fingerprint_of("calibration"),
    message:
        "Calibrate the camera of {wildcards.sequence}."
    script:
        "../scripts/run_stage.py"


rule frames:
    input:
        source=source_if_sound,
        masks=given("keyframe_masks"),
    output:
        frames="results/{sequence}/01_frames/frames.zarr.zip",
    log:
        "results/{sequence}/logs/frames.log",
    benchmark:
        "results/{sequence}/benchmarks/frames.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: THREADS
    resources:
        mem_mb=megabytes(1500),
        runtime=minutes(30),
    params:
        code=code_of("frames"),
        settings=settings_of("frames"),
        seed=config["seed"],
        content=fingerprint_of("source", "keyframe_masks"),
        refusal=lambda wildcards: fault_of(wildcards.sequence),
    message:
        "Decode the frames of {wildcards.sequence}."
    script:
        "../scripts/run_stage.py"
