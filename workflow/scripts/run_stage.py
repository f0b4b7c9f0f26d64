"""Hand a rule's names to the stage of the same name; the only adapter of rules that work on a sequence."""
# ruff: noqa: E402, F821 (Snakemake defines `snakemake` in a script; what is imported later is imported by the fork)

from pathlib import Path

from threedfs.store.fork_server import hand_over

hand_over()

from threedfs.store.command import run_job


def as_paths(value):
    """Return a path, a list of paths, or None for an optional input that is absent."""
    return Path(value) if isinstance(value, str) else [Path(item) for item in value] or None


run_job(
    snakemake.rule,
    {name: as_paths(value) for name, value in snakemake.input.items()},
    {name: Path(value) for name, value in snakemake.output.items()},
    snakemake.params.settings,
    {
        name: value for name, value in snakemake.wildcards.items() if name not in ("variant", "scope")
    },  # the settings have it, or the paths
    snakemake.params.get("labels", {}),
    store=Path(snakemake.config["store"]),
    fallback=Path(snakemake.config["store_fallback"]) if snakemake.config["store_fallback"] else None,
    made=Path("results/.made"),
    log=Path(snakemake.log[0]),
    threads=snakemake.threads,
    seed=snakemake.params.seed,
    refusal=snakemake.params.get("refusal", ""),
    modules=snakemake.params.get("modules", []),
)
