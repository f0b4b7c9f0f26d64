"""Contract: the metric scale is found only where it is asked for, from what tells it."""

from __future__ import annotations

import json
import re

CONFIGURATION = "sequences: {{mug: {{source: config/config.yaml, dataset: own{scale}}}}}\n"


def plan(project, scale):
    """Return the rules that a dry run up to the scale of a sequence names."""
    (project.folder / "own.yaml").write_text(CONFIGURATION.format(scale=scale))
    said = project.run("--dry-run", "--configfile", "own.yaml", "--until", "scale")
    return set(re.findall(r"^(\w+) +1$", said, re.MULTILINE)) - {"total"}


def test_no_scale_is_looked_for_without_being_asked(project):
    assert "scale" not in plan(project, "")


def test_a_tag_is_looked_for_in_the_frames_and_a_height_taken_of_the_mesh(project):
    assert plan(project, ", scale: {tag: 40mm}") == {"frames", "features", "poses", "scale"}
    assert {"scale", "locate", "object"} <= plan(project, ", scale: {height: 95mm}")


def test_a_scale_that_is_not_asked_for_any_more_is_removed(finished):
    stale = finished.folder / "results/sample/11_object/scale.json"
    stale.write_text(json.dumps({"schema": "threedfs/scale/1"}))
    (finished.folder / "results/tables/metrics.csv").unlink()
    finished.run()
    assert not stale.exists()
