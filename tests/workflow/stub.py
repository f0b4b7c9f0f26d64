"""What every stand-in for a stage does: write what it was given, so that a test sees what reached whom."""

from __future__ import annotations

import hashlib
import json
import os
import time
from pathlib import Path

MARKER = 0
PAUSE = float(os.environ.get("STUB_PAUSE", "0"))


def write(stage, inputs, outputs, names, params, job):
    """Write each output: digests of the inputs, the parameters, and a marker that tests edit."""
    job.progress.note("at work")
    given = {"stage": stage, "names": names, "params": repr(params), "marker": MARKER, "header": dict(job.header)}
    given["inputs"] = {name: digest(value, names.get("keyframe")) for name, value in inputs.items()}
    for name, path in outputs.items():
        text = json.dumps({"output": name, **given}, sort_keys=True)
        if path.name in ("masks", "depth", "textured"):
            path.mkdir()
            path = path / "000001.png"
        elif path.name == "keyframes.json":
            entries = {"000001": {"near": 1}, "000002": {"near": 2}}
            text = json.dumps(
                {
                    "schema": "threedfs/keyframes/1",
                    "needs_stereo": "stereo_angle=0.0" in given["params"],
                    "order": [*entries],
                    "keyframes": entries,
                    **given,
                }
            )
        elif path.suffix == ".csv":
            method = {"depth_experiment": "depth/all"}.get(stage, names.get("method", ""))
            figure = "photo_psnr,30,dB" if stage == "photographs" else "iou_mean,0.5,1"
            row = f"{figure},{names['dataset']},{names['sequence']},{method},"
            text = f"name,value,unit,dataset,sequence,method,keyframe\n{row}\n"
        path.write_text(text[:10])
        time.sleep(PAUSE)
        path.write_text(text)


def digest(value: Path | list[Path] | None, keyframe: str | None):
    """Digest an input as a stage sees it: of the keyframes, a job on one sees its entry."""
    if value is None:
        return None
    if isinstance(value, list):
        return [digest(item, keyframe) for item in value]
    if value.is_dir():
        return {file.name: digest(file, keyframe) for file in sorted(value.iterdir())}
    if value.name == "keyframes.json" and keyframe is not None:
        return json.loads(value.read_text())["keyframes"][keyframe]
    return hashlib.sha256(value.read_bytes()).hexdigest()
