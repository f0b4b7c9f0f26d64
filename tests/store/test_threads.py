"""Contract: workers can be forked after the imports, for these leave no thread, which a fork would lose."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = """
import os
from pathlib import Path
from threedfs.store.perform import load_stages
load_stages({{name: {{}} for name in {modules}}}, Path({store!r}), 1)
print(len(os.listdir("/proc/self/task")))
"""
STAGES = ("semidense", "edges", "superpixels", "stereo", "stereo_check", "depth", "depth_trial")


@pytest.mark.skipif(sys.platform != "linux", reason="counts the threads that Linux lists")
def test_importing_stages_on_keyframes_starts_no_thread(tmp_path):
    program = PROGRAM.format(modules=[f"threedfs.stages.{stage}" for stage in STAGES], store=str(tmp_path))
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["1"]
    assert not any(Path(tmp_path).rglob("*.nb?"))  # and compiles nothing
