# Configuration, the keyframe list and the parameters that all rules have.
import json
import sys
import time

from threedfs.errors import UserError
from threedfs.params.configuration import load_sequences
from threedfs.store.code import digest_code
from threedfs.store.digests import InputDigests
from threedfs.store.run_lock import take_over

NOTES = sys.stderr if workflow.is_main_process else None  # jobs read the rules again
try:
    SEQUENCES = load_sequences(config, Path(workflow.basedir), NOTES)
except UserError as fault:
    sys.exit(f"threedfs: {fault}")

OBJECTS = [name for name in SEQUENCES if SEQUENCES[name]["object"]]
TRIED = [name for name in SEQUENCES if SEQUENCES[name]["depth_experiment"]]
RUN_LOCK = take_over(Path(".snakemake")) if workflow.is_main_process else None
STARTED = time.time()
STORE_DIGESTS = InputDigests(Path(config["store"]) / "digests")


wildcard_constraints:
    sequence="[^/]+",
    keyframe="[^/]+",
    method="[^/]+",


def code_of(stage):
    """Return the digest of a stage's code: an edit reruns the stage, a comment does not."""
    return digest_code(f"threedfs.stages.{stage}").digest


def settings_of(stage):
    """Return the slice of the configuration that a stage reads."""
    return config.get(stage, {})


def given(key):
    """Return an input function: a file or folder that the configuration names for a sequence, or nothing.

    A folder's own time says little about its files: `fingerprint_of` watches those.
    """

    def find(wildcards):
        path = SEQUENCES[wildcards.sequence][key]
        return [] if path is None else ancient(path) if Path(path).is_dir() else path

    return find


def fingerprint_of(*keys):
    """Return a params function: digests of the folders that the configuration names for a sequence."""

    def digest(wildcards):
        paths = [Path(SEQUENCES[wildcards.sequence][key] or "") for key in keys]
        return [
            STORE_DIGESTS.folder_of_files(path) if path.name and path.is_dir() else ""
            for path in paths
        ]

    return digest


def per_keyframe(pattern, choose=lambda names, sequence: names):
    """Return an input function: one file per (chosen) keyframe, in their order."""

    def find(wildcards):
        keyframes = checkpoints.keyframes.get(
            sequence=wildcards.sequence
        ).output.keyframes
        names = json.loads(Path(keyframes).read_text())["order"]
        names = choose(names, SEQUENCES[wildcards.sequence])
        return expand(pattern, keyframe=names, allow_missing=True)

    return find
