"""Time and memory of planning: a dry run over many sequences, whose stages up to the keyframes are done by stand-ins.

    python benchmarks/planning.py 12 100 1000

Every sequence has a video of its own, which is looked at before anything is planned, and 24 keyframes, which the
stand-ins name, so that the plan goes on after the checkpoint. A second plan finds its videos looked at.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from threedfs.synthetic.video import write_video

ROOT = Path(__file__).resolve().parents[1]
KEYFRAMES = [f"{index:06d}" for index in range(24)]


def write_sequences(folder: Path, count: int) -> Path:
    """Write a configuration of sequences, a short video for each, and their keyframes.

    Returns
    -------
    Path
        The configuration.
    """
    grey = np.full((48, 64, 3), 128, np.uint8)
    write_video(folder / "video.mp4", (grey for _ in range(30)), rate=30, quality=28)
    configuration = folder / "sequences.yaml"
    names = [f"s{index:05d}" for index in range(count)]
    configuration.write_text("sequences:\n" + "".join(f"  {name}: {{source: {name}.mp4}}\n" for name in names))
    entries = {name: {"neighbours": []} for name in KEYFRAMES}
    text = json.dumps({"needs_stereo": False, "order": KEYFRAMES, "keyframes": entries})
    for name in names:
        shutil.copy(folder / "video.mp4", folder / f"{name}.mp4")
        for file in ("01_frames/frames.zarr.zip", "02_poses/features.zarr.zip", "02_poses/poses.json"):
            path = folder / "results" / name / file
            path.parent.mkdir(parents=True, exist_ok=True)
            path.touch()
        (folder / "results" / name / "02_poses/points.zarr.zip").touch()
        (folder / "results" / name / "03_keyframes").mkdir()
        (folder / "results" / name / "03_keyframes/keyframes.json").write_text(text)
    return configuration


def plan(folder: Path, configuration: Path, options: list[str]) -> tuple[float, float, float, int]:
    """Make a dry run; return its seconds by the wall and of the processor, its peak of memory in MB, and its jobs."""
    command = [
        sys.executable,
        "-m",
        "snakemake",
        "--snakefile",
        str(ROOT / "Snakefile"),
        "--dry-run",
        "--quiet",
        "rules",
    ]
    # outputs without a record of how they were made count as up to date by their times alone
    command += ["--rerun-triggers", "mtime", "--cores", "2", *options]
    command += ["--configfile", str(configuration)]
    environment = {**os.environ, "PYTHONPATH": f"{ROOT / 'src'}:{os.environ.get('PYTHONPATH', '')}"}
    before, started = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(done.stdout + done.stderr)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    jobs = [int(number) for number in re.findall(r"^total\s+(\d+)", done.stdout + done.stderr, re.MULTILINE)]
    return time.monotonic() - started, processor, after.ru_maxrss / 1024, jobs[-1] if jobs else 0


def main() -> None:
    """Print a line for each number of sequences."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("counts", type=int, nargs="+", help="numbers of sequences, rising")
    parser.add_argument("--options", default="", help="more options of Snakemake, as '--batch all=1/10'")
    arguments = parser.parse_args()
    for count in sorted(arguments.counts):
        with tempfile.TemporaryDirectory() as folder:
            configuration = write_sequences(Path(folder), count)
            for time_of in ("first", "second"):
                wall, processor, peak, jobs = plan(Path(folder), configuration, arguments.options.split())
                print(
                    f"{count} sequences, {time_of} plan: {jobs} jobs, {wall:.0f} s, {processor:.0f} core-s, "
                    f"{peak:.0f} MB",
                    flush=True,
                )


if __name__ == "__main__":
    main()
