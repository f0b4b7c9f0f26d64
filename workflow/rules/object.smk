# 11: the object alone: closed mesh, silhouettes, masks; the mesh with a texture.


rule object:
    input:
        field=field_of_method,
        located="results/{sequence}/07_fusion/located/{method}.zarr.zip",
        keyframes="results/{sequence}/04_crops/keyframes.json",
        poses="results/{sequence}/02_poses/poses.json",
        frames="results/{sequence}/01_frames/frames.zarr.zip",
    output:
        mesh="results/{sequence}/11_object/{method}/mesh.ply",
        volume="results/{sequence}/11_object/{method}/volume.zarr.zip",
        silhouettes="results/{sequence}/11_object/{method}/silhouettes.zarr.zip",
        masks=directory("results/{sequence}/11_object/{method}/masks"),
    log:
        "results/{sequence}/logs/object/{method}.log",
    benchmark:
        "results/{sequence}/benchmarks/object/{method}.tsv"
    wildcard_constraints:
        method="|".join(FIELDS),
    conda:
        "../../envs/threedfs.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("object"),
        runtime=minutes(30),
    params:
        code=code_of("object"),
        settings=settings_of("object"),
        seed=config["seed"],
    message:
        "Extract the object of {wildcards.sequence} by {wildcards.method}."
    script:
        "../scripts/run_stage.py"


rule poisson:
    input:
        cloud="results/{sequence}/08_densify/points.zarr.zip",
        support="results/{sequence}/03_scene/support.json",
        keyframes="results/{sequence}/04_crops/keyframes.json",
        poses="results/{sequence}/02_poses/poses.json",
        frames="results/{sequence}/01_frames/frames.zarr.zip",
    output:
        mesh="results/{sequence}/11_object/poisson/mesh.ply",
        silhouettes="results/{sequence}/11_object/poisson/silhouettes.zarr.zip",
        masks=directory("results/{sequence}/11_object/poisson/masks"),
    log:
        "results/{sequence}/logs/object/poisson.log",
    benchmark:
        "results/{sequence}/benchmarks/object/poisson.tsv"
    conda:
        "../../envs/threedfs.yaml"
    threads: 1
    resources:
        mem_mb=megabytes(3000),
        runtime=minutes(60),
    params:
        code=code_of("poisson"),
        settings=settings_of("poisson"),
        seed=config["seed"],
    message:
        "Mesh the surface points of {wildcards.sequence}."
    script:
        "../scripts/run_stage.py"


rule cut_object:
    input:
        labels=labels_of_method,
        field=field_to_cut,
        support="results/{sequence}/03_scene/support.json",
        keyframes="results/{sequence}/04_crops/keyframes.json",
        poses="results/{sequence}/02_poses/poses.json",
        crops="results/{sequence}/04_crops/crops.zarr.zip",
    output:
        mesh="results/{sequence}/11_object/{method}{variant}/mesh.ply",
        silhouettes="results/{sequence}/11_object/{method}{variant}/silhouettes.zarr.zip",
        masks=directory("results/{sequence}/11_object/{method}{variant}/masks"),
    log:
        "results/{sequence}/logs/object/{method}{variant}.log",
    benchmark:
        "results/{sequence}/benchmarks/object/{method}{variant}.tsv"
    wildcard_constraints:
        method="|".join(CUTS),
    conda:
        "../../envs/threedfs.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("cut_object"),
        runtime=minutes(30),
    params:
        code=code_of("cut_object"),
        settings=settings_of("cut_object"),
        seed=config["seed"],
    message:
        "Mesh the object of {wildcards.sequence} by {wildcards.method}{wildcards.variant}."
    script:
        "../scripts/run_stage.py"


rule pixel_masks:
    input:
        labels=labels_of_method,
        keyframes="results/{sequence}/04_crops/keyframes.json",
        poses="results/{sequence}/02_poses/poses.json",
        frames="results/{sequence}/01_frames/frames.zarr.zip",
    output:
        silhouettes="results/{sequence}/11_object/{method}{variant}/silhouettes.zarr.zip",
        masks=directory("results/{sequence}/11_object/{method}{variant}/masks"),
    log:
        "results/{sequence}/logs/object/{method}{variant}.log",
    benchmark:
        "results/{sequence}/benchmarks/object/{method}{variant}.tsv"
    wildcard_constraints:
        method="|".join(PIXEL_CUTS),
    conda:
        "../../envs/threedfs.yaml"
    threads: 1
    resources:
        mem_mb=megabytes(1000),
        runtime=minutes(20),
    params:
        code=code_of("pixel_masks"),
        settings=settings_of("pixel_masks"),
        seed=config["seed"],
    message:
        "Masks of {wildcards.sequence} by {wildcards.method}{wildcards.variant}."
    script:
        "../scripts/run_stage.py"


rule surface:
    input:
        labels=labels_of_method,
        appearance=appearance_of_method,
        keyframes="results/{sequence}/04_crops/keyframes.json",
        depth="results/{sequence}/06_depth",
        consistency="results/{sequence}/07_fusion/consistency.zarr.zip",
        support="results/{sequence}/03_scene/support.json",
        poses="results/{sequence}/02_poses/poses.json",
        crops="results/{sequence}/04_crops/crops.zarr.zip",
    output:
        mesh="results/{sequence}/11_object/{method}{variant}/mesh.ply",
        silhouettes="results/{sequence}/11_object/{method}{variant}/silhouettes.zarr.zip",
        masks=directory("results/{sequence}/11_object/{method}{variant}/masks"),
    log:
        "results/{sequence}/logs/object/{method}{variant}.log",
    benchmark:
        "results/{sequence}/benchmarks/object/{method}{variant}.tsv"
    wildcard_constraints:
        method="|".join(SURFACES),
    priority: FIRST
    conda:
        "../../envs/threedfs.yaml"
    threads: THREADS
    resources:
        mem_mb=memory_of("surface", grid="surface"),
        runtime=minutes(60),
    params:
        code=code_of("surface"),
        settings=settings_of("surface"),
        seed=config["seed"],
        labels=lambda wildcards: {
            "fusion": settings_of("fuse_object")(wildcards),
            "segmentation": settings_of("segment")(wildcards),
        },
    message:
        "Surface of {wildcards.sequence} by {wildcards.method}{wildcards.variant}."
    script:
        "../scripts/run_stage.py"


rule texture:
    input:
        mesh="results/{sequence}/11_object/{method}{variant}/mesh.ply",
        support="results/{sequence}/03_scene/support.json",
        keyframes="results/{sequence}/04_crops/keyframes.json",
        crops="results/{sequence}/04_crops/crops.zarr.zip",
    output:
        glb="results/{sequence}/11_object/{method}{variant}/mesh.glb",
        textured=directory("results/{sequence}/11_object/{method}{variant}/textured"),
    log:
        "results/{sequence}/logs/texture/{method}{variant}.log",
    benchmark:
        "results/{sequence}/benchmarks/texture/{method}{variant}.tsv"
    wildcard_constraints:
        method="|".join(SURFACES),
    priority: FIRST
    conda:
        "../../envs/threedfs.yaml"
    threads: 1
    resources:
        # a mesh that is not simplified has ten times the vertices
        mem_mb=lambda wildcards, attempt: grow_memory(
            2000 if settings_of("texture")(wildcards)["tolerance"] else 5000, attempt
        ),
        runtime=minutes(30),
    params:
        code=code_of("texture"),
        settings=settings_of("texture"),
        seed=config["seed"],
    message:
        "Paint the surface of {wildcards.sequence} by {wildcards.method}{wildcards.variant}."
    script:
        "../scripts/run_stage.py"
