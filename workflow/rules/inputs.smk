# Where rules find their inputs: what the configuration names, and what depends on the keyframes.

from functools import lru_cache

from threedfs.inputs.check import find_fault
from threedfs.params.configuration import JOINT_METHODS, MESH_METHODS
from threedfs.io.truth_files import choose_with_depth
from threedfs.memory import (
    estimate_memory,
    estimate_memory_of_keyframes,
    estimate_memory_of_matting,
)
from threedfs.store.place import Store
from threedfs.store.results import read_result

FIELDS = {  # where each method that has one finds the object's field
    "fused_sdf": "07_fusion/object.zarr.zip",
    "deformed_sdf": "09_deform/volume.zarr.zip",
    "tsdf": "07_fusion/baseline/tsdf.zarr.zip",
    "soft_maximum": "07_fusion/baseline/soft_maximum.zarr.zip",
    "hard_maximum": "07_fusion/baseline/hard_maximum.zarr.zip",
}
CUTS = {  # which labels of voxels the other methods with a mesh take it from
    "volumetric_gc": "volumetric",
    "gc_2d3d_voxel": "joint",
    "gc_select": "joint",
    "sdf_2d3d_voxel": "joint",
}
SURFACES = {"surface": "joint"}  # methods that weigh depth against masks
PIXEL_CUTS = {  # methods of masks alone
    "gc_2d": "images",
    "gc_2d3d_pixel": "joint",
    "spectral_matting": "spectral",
}
METHODS = [
    *config["methods"],
    *(
        f"{method}@{variant}"
        for method in config["methods"]
        if method in JOINT_METHODS
        for variant in VARIANTS
    ),
]

PAINTED = [method for method in METHODS if method.partition("@")[0] in SURFACES]


def given(key):
    """Return an input function: a file or folder that the configuration names for a sequence, or nothing.

    What the run does not make counts by its content, which `fingerprint_of` tells: times say little about it.
    """

    def find(wildcards):
        sequence = SEQUENCES[wildcards.sequence]
        path, own = sequence[key], not sequence["rendered"]
        return path and (ancient(path) if own else path) or []

    return find


def fingerprint_of(*keys):
    """Return a params function: digests of what the configuration names for a sequence, if no rule makes it."""

    def digest(wildcards):
        sequence = SEQUENCES[wildcards.sequence]
        own = [] if sequence["rendered"] else keys
        return [
            STORE_DIGESTS.any(Path(sequence[key])) if sequence[key] else ""
            for key in own
        ]

    return digest


@lru_cache(maxsize=None)
def fault_of(sequence):
    """Return why a sequence cannot be worked on, empty if nothing speaks against it."""
    if sequence in MISSING or SEQUENCES[sequence]["rendered"]:
        return MISSING.get(sequence, "")
    own = SEQUENCES[sequence]["settings"].get("frames", {})
    fault, notes = find_fault(
        SEQUENCES[sequence], config["frames"] | own, Path(config["store"]) / "inputs"
    )
    if NOTES:
        NOTES.writelines(f"note: inputs of {sequence}: {note}\n" for note in notes)
    return fault


def source_if_sound(wildcards):
    """Return a sequence's images; end the run before it starts if the sequence cannot be worked on.

    Unless others are to be finished: then its first job gets the sentence, and fails with it.
    """
    fault = fault_of(wildcards.sequence) if workflow.is_main_process else ""
    settings = workflow.execution_settings  # none where only the rules are listed
    if fault and settings and (len(SEQUENCES) == 1 or not settings.keep_going):
        where = (
            "" if wildcards.sequence in MISSING else f"inputs of {wildcards.sequence}: "
        )
        sys.exit(f"threedfs: {where}{fault}")
    return given("source")(wildcards)


def read_made(path):
    """Return the content of a JSON file of the results, as its job wrote it."""
    fallback = config["store_fallback"]
    store = Store(
        Path(config["store"]),
        Path(fallback) if fallback else None,
        Path("results/.made"),
    )
    try:
        return read_result(Path(path), store)
    except UserError as fault:
        sys.exit(f"threedfs: {fault}")


def read_keyframes(wildcards):
    """Return the content of a sequence's keyframes.json, once the checkpoint has written it."""
    return read_made(
        checkpoints.keyframes.get(sequence=wildcards.sequence).output.keyframes
    )


def count_trials(wildcards):
    """Return how many keyframes of a sequence are to take part in the depth experiment."""
    return settings_of("depth_experiment")(wildcards)["keyframes"]


def choose_trials(wildcards, input):
    """Return the keyframes that take part in the depth experiment, among those with a true depth image."""
    order = read_made(input.keyframes)["order"]
    folder = SEQUENCES[wildcards.sequence]["truth_depth"]
    return choose_with_depth(order, folder, count_trials(wildcards))


def is_wide(wildcards):
    """Say whether the neighbours of a sequence's keyframes are far apart, so that depth needs stereo."""
    return read_keyframes(wildcards)["needs_stereo"]


def if_wide(pattern):
    """Return an input function: a folder, if keyframes are far apart, or nothing."""
    return lambda wildcards: pattern if is_wide(wildcards) else []


def box_of_scope(wildcards):
    """Return where the object is, or nothing in the scene pass, which looks for it."""
    return [] if wildcards.scope else "results/{sequence}/03_scene/support.json"


def results_of_method(method):
    """Return the names of what a method makes: those of pixels have no mesh, and few have a texture."""
    has_mesh = method.partition("@")[0] not in PIXEL_CUTS
    painted = ["mesh.glb", "textured"] if method in PAINTED else []
    return [*(["mesh.ply"] if has_mesh else []), *painted, "masks"]


def mesh_of_method(wildcards):
    """Return a method's mesh, or nothing for one that has none."""
    has_mesh = "mesh.ply" in results_of_method(wildcards.method)
    return "results/{sequence}/11_object/{method}/mesh.ply" if has_mesh else []


def labels_of_method(wildcards):
    """Return the labels that a method takes the object from."""
    cut = (CUTS | PIXEL_CUTS | SURFACES)[wildcards.method]
    own = "segment" in VARIANTS.get(wildcards.variant[1:], {})
    name = f"{cut}{wildcards.variant if own else ''}"
    return f"results/{wildcards.sequence}/10_segment/{name}.zarr.zip"


def appearance_of_method(wildcards):
    """Return what the segmentation that a method takes the object from has learnt of its looks."""
    labels = Path(labels_of_method(wildcards))
    return str(labels.parent / "appearance" / labels.name)


def mesh_to_measure():
    """Return the method whose mesh is the one to look at, None without any mesh."""
    return next((method for method in MESH_METHODS if method in METHODS), None)


def known_of(wildcards):
    """Return what is known of a sequence's size, and by which mesh it is measured if that is the object's height."""
    known = SEQUENCES[wildcards.sequence]["scale"]
    return known | (
        {"method": mesh_to_measure()} if known["source"] == "height" else {}
    )


def to_measure(path, *sources):
    """Return an input function: a file, if the size of a sequence is found by one of the sources, or nothing."""

    def find(wildcards):
        known = SEQUENCES[wildcards.sequence]["scale"]
        return (
            path.format(sequence=wildcards.sequence, method=mesh_to_measure())
            if known and known["source"] in sources
            else []
        )

    return find


def field_to_search(wildcards):
    """Return the field that the object is looked for in."""
    return f"results/{wildcards.sequence}/{FIELDS[wildcards.field]}"


def segmented_method(wildcards):
    """Return the method whose field the segmentation weighs."""
    return f"{settings_of('segment')(wildcards)['field']}_sdf"


def field_to_segment(wildcards):
    """Return the field that the segmentation weighs."""
    return f"results/{wildcards.sequence}/{FIELDS[segmented_method(wildcards)]}"


def located_to_segment(wildcards):
    """Return where the object is in that field."""
    return f"results/{wildcards.sequence}/07_fusion/located/{segmented_method(wildcards)}.zarr.zip"


def count_keyframes(input):
    """Return the number of keyframes that a job reads; 0 before it is known, or for a job that reads none."""
    keyframes = Path(input.get("keyframes", ""))
    return len(read_made(keyframes)["order"]) if keyframes.is_file() else 0


def pixels_of_view(wildcards):
    """Return the pixels of a keyframe as a job sees it: of a crop, or of a small whole frame in the scene pass."""
    if wildcards.get("scope", ""):
        return 0.75 * settings_of("shrink")(wildcards)["longest_side"] ** 2
    crops = settings_of("crops")(wildcards)
    whole = crops["whole"] or wildcards.sequence not in OBJECTS
    return 0.75 * crops["longest_side"] ** 2 if whole else crops["pixels"]


def memory_of(stage, grid="fuse_object", unknowns=lambda wildcards: 0):
    """Return a resource function: the MB that a stage needs on the grid of another, and for a fit of unknowns."""

    def estimate(wildcards, input, attempt):
        side = settings_of(grid)(wildcards)["longest_side"]
        pixels, keyframes = pixels_of_view(wildcards), count_keyframes(input)
        needed = estimate_memory(stage, side, pixels, keyframes, unknowns(wildcards))
        return grow_memory(needed, attempt)

    return estimate


def memory_of_keyframes(rule):
    """Return a resource function: the MB of a job that works on as many keyframes at once as it has threads."""

    def estimate(wildcards, threads, attempt):
        searched = rule in ("depth", "depth_trial")
        candidates = settings_of("depth")(wildcards)["candidates"] if searched else 0
        pixels = pixels_of_view(wildcards)
        needed = estimate_memory_of_keyframes(rule, pixels, threads, candidates)
        return grow_memory(needed, attempt)

    return estimate


def memory_of_matting(wildcards, input, attempt):
    """Return the MB that spectral matting needs: of the field, of all masks, and of one image at work."""
    settings = settings_of("spectral_matting")(wildcards)
    side = settings_of("fuse_object")(wildcards)["longest_side"]
    pixels, keyframes = pixels_of_view(wildcards), count_keyframes(input)
    held = estimate_memory("spectral_matting", side, pixels, keyframes)
    work = estimate_memory_of_matting(settings["pixels"], settings["eigenvectors"])
    return grow_memory(held + work, attempt)


def minutes(once, each=0):
    """Return a resource function: the run time of a job, several times what it takes, and more at every attempt.

    `each` is of a keyframe; as many are worked on at once as there are threads.
    """

    def estimate(wildcards, input, threads, attempt):
        return attempt * int(once + each * count_keyframes(input) / threads)

    return estimate


def unknowns_of_correction(wildcards):
    """Return the number of coefficients that the correction is fitted with."""
    return settings_of("deform")(wildcards)["controls"]


def field_to_cut(wildcards):
    """Return the field whose zero level labels cut out, or nothing for methods of labels alone."""
    return field_to_segment(wildcards) if wildcards.method == "sdf_2d3d_voxel" else []


def field_of_method(wildcards):
    """Return the signed distance field that a method takes the object from."""
    return f"results/{wildcards.sequence}/{FIELDS[wildcards.method]}"


def finds_cuda(wildcards):
    """Say whether COLMAP can match patches here; asked only where the configuration leaves it open."""
    settings = settings_of("densify")(wildcards)
    if not settings["points"] or settings["engine"] != "auto":
        return False
    from threedfs.colmap.workspace import can_match_on_gpu

    return can_match_on_gpu()


def if_matched_here(pattern):
    """Return an input function: a folder, if our own patch match is to make the points, or nothing."""

    def find(wildcards):
        settings = settings_of("densify")(wildcards)
        engine = choose_engine(
            settings["points"], settings["engine"], finds_cuda(wildcards)
        )
        return pattern if engine == "cpu" else []

    return find
