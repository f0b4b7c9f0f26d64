# How a run begins and ends; functions, not rules.
import time

from threedfs.store.run_lock import take_over

RUN_LOCK = take_over(Path(".snakemake")) if workflow.is_main_process else None
STARTED = time.time()


def refuse_missing():
    """End the run if a file of a sequence is missing, unless the others are to be finished."""
    if MISSING and not workflow.execution_settings.keep_going:
        sys.exit(f"threedfs: {next(iter(MISSING.values()))}")


def finish(unfinished=()):
    """Write tables and plots and say how the run went; `unfinished` are outputs that it should have made."""
    from threedfs.run_end.finish import Run, finish_run

    run = Run(
        Path("results"),
        Path(config["store"]),
        STARTED,
        {sequence: entry["dataset"] for sequence, entry in SEQUENCES.items()},
        tuple(config["methods"]),
        tuple(Path(table) for table in rules.collect.input),
        config["seed"],
    )
    sys.stderr.write(finish_run(run, [str(path) for path in unfinished]))
