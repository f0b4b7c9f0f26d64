# Configuration, sequences and the parameters that all rules have.
import json
import re
import sys

from threedfs.densify.engine import choose_engine
from threedfs.errors import UserError
from threedfs.params.sequences import load_sequences
from threedfs.store.code import digest_code, library_versions
from threedfs.store.digests import InputDigests

NOTES = sys.stderr if workflow.is_main_process else None  # jobs read the rules again
try:
    SEQUENCES, MISSING = load_sequences(config, Path(workflow.basedir), NOTES)
except UserError as fault:
    sys.exit(f"threedfs: {fault}")

OBJECTS = [name for name in SEQUENCES if SEQUENCES[name]["object"]]
MEASURED = [name for name in SEQUENCES if SEQUENCES[name]["scale"]]
TRIED = [name for name in SEQUENCES if SEQUENCES[name]["depth_experiment"]]
# Jobs on a sequence that can use two cores get them where there is one sequence. Of several, others fill the second core:
# it would idle while such a job waits for both, and through half of the work on poses.
THREADS = 2 if len(SEQUENCES) == 1 else 1
# Keyframes that a job works on at once: on this machine its cores, shared by the sequences; on a cluster a part of a node.
CORES = workflow.resource_settings.cores
KEYFRAMES_AT_ONCE = 8 if CORES is None else max(1, CORES // max(1, len(SEQUENCES)))
STORE_DIGESTS = InputDigests(Path(config["store"]) / "digests")


VARIANTS = config["variants"] or {}


wildcard_constraints:
    sequence="[^/]+",
    method="[^/]+",
    scope="(03_scene/)?",  # the scene pass, on small whole frames; empty for the pass on crops of the object
    variant="(@[^/]+)?",  # of the joint segmentation; empty for the configuration itself


def code_of(stage, *modules):
    """Return the digest of a stage's code, and the versions of its libraries: what changes either reruns the stage."""
    code = digest_code(f"threedfs.stages.{stage}", *modules)
    return {"digest": code.digest, "versions": library_versions(code.libraries)}


def settings_of(stage):
    """Return a function of the wildcards: the configuration that a stage reads, the sequence's own, the variant's."""

    def find(wildcards):
        own = (
            SEQUENCES[wildcards.sequence]["settings"]
            if "sequence" in wildcards.keys()
            else {}
        )
        variant = VARIANTS.get(wildcards.get("variant", "")[1:], {})
        return config.get(stage, {}) | own.get(stage, {}) | variant.get(stage, {})

    return find


def settings_of_each(*stages):
    """Return a function of the wildcards: the configuration that each of several stages reads, by stage."""
    return lambda wildcards: {stage: settings_of(stage)(wildcards) for stage in stages}


def memory_of_keyframes(megabytes):
    """Return a resource function: the MB of a job that needs so many for each keyframe that it works on at once."""
    return lambda wildcards, threads: megabytes * threads
