# How a run begins and ends; functions, not rules.
import time

from threedfs.run_end.cut_short import ask_to_collect_again
from threedfs.store.fork_server import start_server
from threedfs.store.half_filled import remove_half_filled
from threedfs.store.heartbeat import name_run
from threedfs.store.leftovers import wait_for_leftovers
from threedfs.store.run_lock import take_over

RUN_LOCK = take_over(Path(".snakemake")) if workflow.is_main_process else None
if workflow.is_main_process:
    name_run()
if RUN_LOCK:
    remove_half_filled(Path(".snakemake"), Path("results"))
    ask_to_collect_again(Path("results"))
STARTED = time.time()
REPORTED = ("cv2", "numba", "numpy", "pycolmap", "scipy", "skimage", "trimesh", "zarr")


def wait_for_cluster():
    """Let jobs end that a run left on a cluster when it was killed; this one then takes their work from the store."""
    if RUN_LOCK:
        wait_for_leftovers(
            Path(), lambda sentence: sys.stderr.write(f"threedfs: {sentence}\n")
        )


def forget_scales():
    """Remove the scales of sequences that do not ask for one now: they may be of another mesh than the one made next."""
    for sequence in set(SEQUENCES) - set(MEASURED):
        Path("results", sequence, "11_object/scale.json").unlink(missing_ok=True)


def look_on_demand():
    """Let Snakemake look for the next job when one ends and only then, where jobs run on this machine.

    Its limit on submissions starts a timer at every look, and each timer ends in a look (as of 9.27): after n jobs it
    looks n times a second, which takes most of a core from the jobs.
    """
    if workflow.executor_plugin.common_settings.local_exec:
        workflow.scheduler.job_rate_limiter = None


def fork_on_demand():
    """Have jobs on this machine forked from a process that has imported the libraries."""
    if workflow.executor_plugin.common_settings.local_exec:
        start_server()


def finish(unfinished=()):
    """Write tables, plots and reports and say how the run went; `unfinished` are outputs that it should have made."""
    from threedfs.params.changes import list_changes
    from threedfs.run_end.finish import Run, finish_run, report_run

    run = Run(
        Path("results"),
        Path(config["store"]),
        STARTED,
        {sequence: entry["dataset"] for sequence, entry in SEQUENCES.items()},
        tuple(config["methods"]),
        tuple(Path(table) for table in rules.collect.input),
        config["seed"],
        {
            name: list_changes(config, entry["settings"])
            for name, entry in SEQUENCES.items()
        },
        library_versions(REPORTED),
        threads=CORES or 1,
    )
    stale = {str(path) for path in unfinished}
    sys.stderr.write(finish_run(run, stale))
    report_run(run, stale, lambda sentence: sys.stderr.write(f"note: {sentence}\n"))
