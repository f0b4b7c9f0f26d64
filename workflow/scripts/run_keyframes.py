"""Hand a rule's names to its stages, for every keyframe; the only adapter of rules that work on keyframes."""
# ruff: noqa: E402, F821 (Snakemake defines `snakemake` in a script; what is imported later is imported by the fork)

from pathlib import Path

from threedfs.store.fork_server import hand_over

hand_over()

from threedfs.store.command import run_keyframes

run_keyframes(
    snakemake.rule,
    snakemake.params.stages,
    {name: Path(value) if value else None for name, value in snakemake.input.items()},
    {name: Path(value) for name, value in snakemake.output.items()},
    snakemake.params.settings,
    dict(snakemake.wildcards.items()),
    snakemake.params.get("labels", {}),
    store=Path(snakemake.config["store"]),
    fallback=Path(snakemake.config["store_fallback"]) if snakemake.config["store_fallback"] else None,
    made=Path("results/.made"),
    log=Path(snakemake.log[0]),
    threads=snakemake.threads,
    seed=snakemake.params.seed,
    keyframes=snakemake.params.get("keyframes"),
)
