"""The command `threedfs`: the workflow for people who do not know Snakemake."""
