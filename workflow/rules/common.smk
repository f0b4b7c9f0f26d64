# Configuration, sequences, the keyframe list and the parameters that all rules have.
import json
import sys

from threedfs.errors import UserError
from threedfs.params.configuration import (
    check_configuration,
    configuration_schema,
    list_sequences,
    set_aside_missing,
)
from threedfs.store.code import digest_code
from threedfs.store.digests import InputDigests

try:
    check_configuration(config, configuration_schema())
    named = list_sequences(config, Path(workflow.basedir))
    SEQUENCES, MISSING = set_aside_missing(named)
except UserError as fault:
    sys.exit(f"threedfs: {fault}")

STORE_DIGESTS = InputDigests(Path(config["store"]) / "digests")


wildcard_constraints:
    sequence="[^/]+",
    keyframe="[^/]+",
    method="[^/]+",


def code_of(stage, *modules):
    """Return the digest of a stage's code: an edit reruns the stage, a comment does not."""
    return digest_code(f"threedfs.stages.{stage}", *modules).digest


def settings_of(stage):
    """Return the slice of the configuration that a stage reads."""
    return config.get(stage, {})


def given(key):
    """Return an input function: a file or folder that the configuration names for a sequence, or nothing.

    A folder's own time says little about its files: `fingerprint_of` watches those that no rule makes.
    """

    def find(wildcards):
        sequence = SEQUENCES[wildcards.sequence]
        path, own = sequence[key], not sequence["rendered"]
        return path and (ancient(path) if own and Path(path).is_dir() else path) or []

    return find


def fingerprint_of(*keys):
    """Return a params function: digests of a sequence's folders in the configuration, if no rule makes them."""

    def digest(wildcards):
        sequence = SEQUENCES[wildcards.sequence]
        own = [] if sequence["rendered"] else keys
        paths = [Path(sequence[key] or "") for key in own]
        return [
            STORE_DIGESTS.folder_of_files(path) if path.name and path.is_dir() else ""
            for path in paths
        ]

    return digest


def per_keyframe(pattern):
    """Return an input function: one file per keyframe, in the order of the frames."""

    def find(wildcards):
        keyframes = checkpoints.keyframes.get(
            sequence=wildcards.sequence
        ).output.keyframes
        names = json.loads(Path(keyframes).read_text())["order"]
        return expand(pattern, keyframe=names, allow_missing=True)

    return find
