# Configuration, sequences and the parameters that all rules have.
import json
import re
import sys

from threedfs.densify.engine import choose_engine
from threedfs.errors import UserError
from threedfs.inputs.places import check_places
from threedfs.memory import grow_memory
from threedfs.params.command_line import read_scalars
from threedfs.params.configuration import configuration_schema
from threedfs.params.sequences import load_sequences
from threedfs.store.code import digest_code, library_versions
from threedfs.store.digests import InputDigests

NOTES = sys.stderr if workflow.is_main_process else None  # jobs read the rules again
# On a cluster a job reads the rules again, and must come to what was asked for it, not to a share of its node's cores.
CORES = None if workflow.remote_exec else workflow.resource_settings.cores
if CORES is not None and CORES < 1:
    sys.exit(f"threedfs: --cores: expected a whole number of at least 1, got {CORES}.")
try:
    read_scalars(config, workflow.config_settings.config, configuration_schema())
    SEQUENCES, MISSING = load_sequences(config, Path(workflow.basedir), NOTES)
    if workflow.is_main_process:
        check_places(Path(config["store"]), Path("results"), SEQUENCES)
except UserError as fault:
    sys.exit(f"threedfs: {fault}")

OBJECTS = [name for name in SEQUENCES if SEQUENCES[name]["object"]]
MEASURED = [name for name in SEQUENCES if SEQUENCES[name]["scale"]]
TRIED = [name for name in SEQUENCES if SEQUENCES[name]["depth_experiment"]]
# Jobs on a sequence that can use two cores get them where there is one sequence. Of several, others fill the second core:
# it would idle while such a job waits for both, and through half of the work on poses.
THREADS = 2 if len(SEQUENCES) == 1 else 1
# Keyframes that a job works on at once: on this machine its cores, shared by the sequences; on a cluster a part of a node.
KEYFRAMES_AT_ONCE = 8 if CORES is None else max(1, CORES // max(1, len(SEQUENCES)))
FIRST = 1  # priority of the chain to the textured mesh: what hangs on its side fills the second core
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


def megabytes(needed):
    """Return a resource function: the MB of a job that needs so many; twice as many at every further attempt."""
    return lambda wildcards, attempt: grow_memory(needed, attempt)
