# From a handheld video to the mesh of its object: the table of contents.
# Configuration: config/README.md. Stages in order; each is a rule file here and a module in src/threedfs/stages/.
from snakemake.utils import min_version

min_version("9.27")


configfile: Path(workflow.basedir) / "config" / "config.yaml"


include: "workflow/rules/common.smk"
include: "workflow/rules/inputs.smk"
include: "workflow/rules/run.smk"
include: "workflow/rules/render.smk"
include: "workflow/rules/frames.smk"
include: "workflow/rules/poses.smk"
include: "workflow/rules/keyframes.smk"
include: "workflow/rules/scene.smk"
include: "workflow/rules/crops.smk"
include: "workflow/rules/cues.smk"
include: "workflow/rules/stereo.smk"
include: "workflow/rules/depth.smk"
include: "workflow/rules/fusion.smk"
include: "workflow/rules/locate.smk"
include: "workflow/rules/scale.smk"
include: "workflow/rules/densify.smk"
include: "workflow/rules/deform.smk"
include: "workflow/rules/segment.smk"
include: "workflow/rules/object.smk"
include: "workflow/rules/depth_experiment.smk"
include: "workflow/rules/evaluate.smk"


localrules:
    collect,


rule all:
    default_target: True
    input:
        [
            f"results/{sequence}/11_object/{method}/{name}"
            for sequence in OBJECTS
            for method in METHODS
            for name in results_of_method(method)
        ],
        [f"results/{sequence}/11_object/scale.json" for sequence in MEASURED],
        "results/tables/metrics.csv",


onstart:
    wait_for_cluster()
    forget_scales()
    look_on_demand()
    fork_on_demand()


onsuccess:
    finish()


onerror:
    finish([file for job in workflow.dag.needrun_jobs() for file in job.output])
