# 00: film a take of the synthetic data set, where a sequence is rendered.
from threedfs.synthetic.takes import take_module

RENDERED = [  # sequences that are filmed; others of the same take share the film
    name
    for name in SEQUENCES
    if SEQUENCES[name]["rendered"]
    and SEQUENCES[name]["source"].startswith(f"results/{name}/")
]


rule render:
    output:
        video="results/{sequence}/00_render/video.mp4",
        cameras="results/{sequence}/00_render/cameras.json",
        mesh="results/{sequence}/00_render/mesh.ply",
        masks=directory("results/{sequence}/00_render/masks"),
        depth=directory("results/{sequence}/00_render/depth"),
    log:
        "results/{sequence}/logs/render.log",
    benchmark:
        "results/{sequence}/benchmarks/render.tsv"
    wildcard_constraints:
        sequence="|".join(map(re.escape, RENDERED)) or "(?!)",
    conda:
        "../../envs/threedfs.yaml"
    threads: THREADS
    resources:
        mem_mb=megabytes(2500),
        runtime=minutes(60),
    params:
        code=lambda wildcards: code_of(
            "render", take_module(SEQUENCES[wildcards.sequence]["rendered"])
        ),
        settings=settings_of("render"),
        seed=config["seed"],
        modules=lambda wildcards: [
            take_module(SEQUENCES[wildcards.sequence]["rendered"])
        ],
        labels=lambda wildcards: {"take": SEQUENCES[wildcards.sequence]["rendered"]},
    message:
        "Film {wildcards.sequence}."
    script:
        "../scripts/run_stage.py"
