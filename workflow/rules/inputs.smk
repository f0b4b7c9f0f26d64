# Where rules find their inputs: what the configuration names, and one file per keyframe.


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


def read_keyframes(wildcards):
    """Return the content of a sequence's keyframes.json, once the checkpoint has written it."""
    keyframes = checkpoints.keyframes.get(sequence=wildcards.sequence).output.keyframes
    return json.loads(Path(keyframes).read_text())


def per_keyframe(pattern, choose=lambda names, sequence: names):
    """Return an input function: one file per (chosen) keyframe, in their order."""

    def find(wildcards):
        names = choose(
            read_keyframes(wildcards)["order"], SEQUENCES[wildcards.sequence]
        )
        return expand(pattern, keyframe=names, allow_missing=True)

    return find


def if_wide(pattern):
    """Return an input function: a file, if the neighbours of a sequence's keyframes are far apart, or nothing."""
    return lambda wildcards: (
        pattern if read_keyframes(wildcards)["needs_stereo"] else []
    )
